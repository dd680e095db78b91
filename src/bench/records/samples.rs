//! `samples.json`: every sample of a run, in the order in which it was taken. The rows are made from it, and
//! a run that was stopped goes on from it.

use super::build_times::BuildTimes;
use super::files::{RecordsError, TELL, read_json, write_whole};
use super::tree_facts::TreeFacts;
use crate::bench::cell::{Cell, Kernel};
use crate::bench::cpu_time::CpuTime;
use crate::bench::memory::BuildMemory;
use crate::bench::planned_scene::PlannedScene;
use crate::geometry::Dropped;
use crate::trace::{Isa, RayKind, verify};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The file in a results folder.
pub const SAMPLES: &str = "samples.json";
/// What can be done where a run to be resumed has not left its files.
pub const NO_RESUME: &str = "nothing can be resumed; run without --resume, or give another folder with --out";

/// One timed trace of a batch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// The kernel.
    pub kernel: Kernel,
    /// The view, from 0.
    pub view: usize,
    /// Kind of rays, or `None` for the whole path-traced frame.
    pub kind: Option<RayKind>,
    /// Which of the visit's passes over all batches it was part of, from 0.
    #[serde(default)]
    pub pass: usize,
    /// Wall clock.
    pub ms: f64,
}

/// One visit to a cell: its builds and traces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VisitSamples {
    /// The round, from 0.
    pub round: usize,
    /// How many cells of the scene were visited before in this round.
    pub place: usize,
    /// The builds.
    pub builds: BuildTimes,
    /// The traces.
    pub timings: Vec<Timing>,
    /// CPU time of the traces.
    #[serde(rename = "load")]
    pub cpu_time: CpuTime,
}

/// The result of the first trace of a batch, untimed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// The view, from 0.
    pub view: usize,
    /// Kind of rays; absent only in a default.
    pub kind: Option<RayKind>,
    /// Rays.
    pub rays: u64,
    /// Rays that hit.
    pub hits: u64,
    /// Hash of the rounded distances.
    pub hash: String,
    /// Answers that equal the reference's.
    pub equal: u64,
    /// Hits of another triangle at the same distance.
    pub ties: u64,
    /// Differences at an edge, where either answer is right.
    pub edge: u64,
    /// Differences on thin triangles that single precision alone explains.
    #[serde(default)]
    pub near_misses: u64,
    /// Inner nodes visited, if counted.
    pub node_visits: Option<u64>,
    /// Leaf blocks tested, if counted.
    pub block_tests: Option<u64>,
}

/// A cell under one kernel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KernelChecks {
    /// The kernel.
    pub kernel: Kernel,
    /// Its instruction set.
    pub isa: String,
    /// Why the kernel cannot trace this tree, where it cannot.
    pub unavailable: Option<String>,
    /// The results of the first trace of each batch.
    pub checks: Vec<Check>,
    /// The first wrong answer: such a kernel has no figures.
    pub mismatch: Option<String>,
}

/// All of a cell in a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellSamples {
    /// The cell.
    #[serde(flatten)]
    pub cell: Cell,
    /// Facts of its tree.
    pub facts: TreeFacts,
    /// Its kernels, as first seen.
    pub checks: Vec<KernelChecks>,
    /// Its visits.
    pub visits: Vec<VisitSamples>,
    /// Bytes of its build, where they could be measured.
    #[serde(default)]
    pub memory: Option<BuildMemory>,
    /// Why there is none, if the builder failed.
    pub error: Option<String>,
}

impl KernelChecks {
    /// Why its answers cannot be accepted, if too many of them are excused.
    pub fn excess(&self) -> Option<String> {
        let total = |value: fn(&Check) -> u64| self.checks.iter().map(value).sum::<u64>();
        verify::excess(total(|c| c.rays), total(|c| c.edge), total(|c| c.near_misses), self.excused())
    }

    /// The share of its answers that rounding excuses: our portable kernel tests triangles by other arithmetic than the
    /// reference.
    pub fn excused(&self) -> f64 {
        let is_portable = self.kernel == Kernel::Phr && self.isa == Isa::Scalar.name();
        if is_portable { verify::OTHER_TEST } else { verify::SAME_TEST }
    }
}

impl CellSamples {
    /// True if the builder failed or some hit is wrong.
    pub fn failed(&self) -> bool {
        self.error.is_some() || self.checks.iter().any(|kernel| kernel.mismatch.is_some())
    }
}

/// All of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneSamples {
    /// Name.
    pub name: String,
    /// Hash of the geometry.
    pub sha: String,
    /// Its origin, without folders.
    pub source: String,
    /// Triangles.
    pub triangles: u64,
    /// Triangles left out.
    pub dropped: Dropped,
    /// What its file had that is not in the mesh, a line each.
    #[serde(default)]
    pub remarks: Vec<String>,
    /// Views traced.
    pub views: usize,
    /// Rays left out because Embree would not accept them.
    pub invalid_rays: u64,
    /// Seconds spent in rounds so far, in all sessions.
    #[serde(default)]
    pub spent: f64,
    /// The cells, in the table's order.
    pub cells: Vec<CellSamples>,
}

impl SceneSamples {
    /// Whether a visit to one of `cells` is still of use: not to those whose builder failed.
    pub fn can_visit(&self, cells: &[Cell]) -> bool {
        let has_failed = |cell: &Cell| self.cells.iter().any(|it| it.cell == *cell && it.error.is_some());
        !cells.iter().all(has_failed)
    }

    /// Rounds that each of `cells` has been visited in, failed ones aside.
    pub fn finished_rounds(&self, cells: &[Cell]) -> usize {
        let rounds = |cell: &Cell| match self.cells.iter().find(|samples| samples.cell == *cell) {
            Some(samples) if samples.error.is_some() => usize::MAX,
            Some(samples) => samples.visits.len(),
            None => 0,
        };
        cells.iter().map(rounds).min().unwrap_or(usize::MAX)
    }
}

/// The whole file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    /// [`super::row::SCHEMA`].
    pub schema: u32,
    /// Names the run.
    pub run_id: String,
    /// The scenes begun so far.
    pub scenes: Vec<SceneSamples>,
}

impl Samples {
    /// Reads the file in `folder`, to go on with its run.
    ///
    /// # Errors
    /// No such file, or no such content.
    pub fn read(folder: &Path) -> Result<Self, RecordsError> {
        read_json(&folder.join(SAMPLES), NO_RESUME)
    }

    /// Writes the file in `folder`, whole or not at all.
    ///
    /// # Errors
    /// An unwritable place.
    pub fn write(&self, folder: &Path) -> Result<(), RecordsError> {
        let path = folder.join(SAMPLES);
        let json = |source| RecordsError::Json { path: path.clone(), source, remedy: TELL };
        let bytes = serde_json::to_vec(self).map_err(json)?;
        write_whole(&path, &bytes)
    }

    /// What a run that goes on with these would have otherwise in `scene`: its rows and those of today could not be
    /// told apart.
    pub fn differ(&self, scene: &PlannedScene, cells: &[Cell]) -> Option<String> {
        let known = self.scene(&scene.name)?;
        if scene.sha.as_ref().is_some_and(|sha| *sha != known.sha) {
            return Some(format!("geometry of {}", scene.name));
        }
        cells.iter().find_map(|cell| {
            let of_name =
                |it: &&CellSamples| (&it.cell.builder, it.cell.width) == (&cell.builder, cell.width);
            let other = known.cells.iter().filter(of_name).find(|it| it.cell != *cell)?;
            let is_other_builder = other.cell.recipe != cell.recipe;
            let what = if is_other_builder { "configuration called" } else { "set of kernels for" };
            Some(format!("{what} {}", cell.builder))
        })
    }

    /// The scene called `name`.
    pub fn scene(&self, name: &str) -> Option<&SceneSamples> {
        self.scenes.iter().find(|scene| scene.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn scene(spent: f64, cells: Vec<CellSamples>) -> SceneSamples {
        SceneSamples {
            name: String::new(),
            sha: String::new(),
            source: String::new(),
            triangles: 0,
            dropped: Dropped::default(),
            remarks: Vec::new(),
            views: 0,
            invalid_rays: 0,
            spent,
            cells,
        }
    }

    /// Else a run whose time is not over would visit nothing for ever.
    #[test]
    fn where_all_builders_failed_there_is_nothing_to_visit() {
        let cell = |width| Cell::new("b", width, &[]);
        let samples = |width, error: Option<&str>| CellSamples {
            cell: cell(width),
            facts: TreeFacts::default(),
            checks: Vec::new(),
            visits: Vec::new(),
            memory: None,
            error: error.map(Into::into),
        };
        let both = [cell(4), cell(8)];
        let visited = |a, b| scene(0.0, vec![samples(4, a), samples(8, b)]).can_visit(&both);
        assert!(visited(None, None) && visited(Some("no memory"), None));
        assert!(!visited(Some("no memory"), Some("no memory")));
        assert!(scene(0.0, vec![samples(4, Some("no memory"))]).can_visit(&both), "not begun");
    }

    /// A run that is resumed writes its samples again: what a reader rounds would drift. Without serde_json's feature
    /// `float_roundtrip` a part of these figures come back as their neighbours.
    #[test]
    fn figures_are_read_to_the_last_bit() {
        let mut random = SplitMix64::new(1);
        let folder = tempfile::tempdir().unwrap();
        let times = (0..10_000).map(|_| (random.next_u64() >> 11) as f64 * 1e-13);
        let scenes = times.map(|spent| scene(spent, Vec::new())).collect();
        let samples = Samples { scenes, ..Samples::default() };
        samples.write(folder.path()).unwrap();
        let bits = |samples: &Samples| -> Vec<u64> {
            samples.scenes.iter().map(|scene| scene.spent.to_bits()).collect()
        };
        assert_eq!(bits(&Samples::read(folder.path()).unwrap()), bits(&samples));
    }
}
