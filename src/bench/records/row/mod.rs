//! The records of a run: `rows.csv`, one row per scene x builder x width x kernel x threads x regime x view
//! x ray kind. `results/README.md` describes the columns for readers of the files.

mod agreement;
mod file;

use crate::bench::rounds::{RowKey, RowRounds};
use crate::bench::statistics::Summary;
use serde::{Deserialize, Serialize};

pub use file::{read, write, write_all};

/// Version of the columns; a reader refuses any other.
pub const SCHEMA: u32 = 1;
/// The file of rows in a results folder.
pub const ROWS: &str = "rows.csv";
/// Value of `view` and `ray_kind` in rows that sum over all of them.
pub const ALL: &str = "all";
/// Value of `kernel` in rows that tell of builds only.
pub const NO_KERNEL: &str = "none";
/// Value of `regime`: the first build of a new builder object or device.
pub const FIRST: &str = "first";
/// Value of `regime`: on warm threads, but a new builder object and new memory each time; Embree: a new scene of
/// the same device. Trees are traced as built so, and builders are compared by it.
pub const FRESH: &str = "fresh";
/// Value of `regime`: the same builder object in the memory of the tree before; Embree: the same scene committed again.
pub const REBUILD: &str = "rebuild";
/// Value of `regime` in runs before there was [`FIRST`].
pub const COLD: &str = "cold";
/// Value of `regime` in runs before there was [`FRESH`]: Embree's builds were fresh, ours reused all memory.
pub const WARM: &str = "warm";
/// How the error of a row begins whose kernel cannot be had here.
pub const UNAVAILABLE: &str = "not available";

/// One line of `rows.csv`. Figures that do not apply or could not be had are empty, never zero.
/// Times are in milliseconds of wall clock.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Names the run.
    pub run_id: String,
    /// Start of the run, ISO 8601.
    pub utc: String,
    /// A name given to the machine, "anonymous" by default.
    pub host: String,
    /// Revision of this program, `-dirty` if the sources differed from it.
    pub git_rev: String,
    /// Scene name.
    pub scene: String,
    /// Hash of the very geometry.
    pub scene_sha: String,
    /// Triangles built over.
    pub triangles: u64,
    /// Builder name.
    pub builder: String,
    /// Its parameters: JSON for ours, the device string for Embree's.
    pub builder_config: String,
    /// Who built the tree, with version: `phr 0.1.0`, `embree 3.13.5`.
    pub engine: String,
    /// Children per node.
    pub width: u32,
    /// Instruction set of the kernel.
    pub isa: String,
    /// Threads given to each side, for building and tracing.
    pub threads: u32,
    /// [`FIRST`], [`FRESH`] or [`REBUILD`]; in older runs [`COLD`] or [`WARM`].
    pub regime: String,
    /// Rounds behind the figures.
    pub rounds: u32,
    /// Build time, median.
    pub build_ms_median: Option<f64>,
    /// Build time, median absolute deviation.
    pub build_ms_mad: Option<f64>,
    /// Build time, least.
    pub build_ms_min: Option<f64>,
    /// Build time, greatest.
    pub build_ms_max: Option<f64>,
    /// Million triangles built per second, from the median.
    pub build_mtri_s: Option<f64>,
    /// Time on processors per triangle of these builds, all threads together, ns.
    #[serde(default)]
    pub build_cpu_ns_per_tri: Option<f64>,
    /// Instructions per triangle of these builds, all threads in user space, where the processor counts them.
    #[serde(default)]
    pub build_instructions_per_tri: Option<f64>,
    /// Cycles, likewise.
    #[serde(default)]
    pub build_cycles_per_tri: Option<f64>,
    /// SAH cost: traversal and intersection cost 1, leaves in blocks of four triangles.
    pub sah: Option<f64>,
    /// End-point overlap (Aila et al. 2013).
    pub epo: Option<f64>,
    /// Inner nodes.
    pub nodes: Option<u64>,
    /// Leaves.
    pub leaves: Option<u64>,
    /// Used lanes of leaf blocks, 0 to 1.
    pub leaf_fill: Option<f64>,
    /// References to triangles per triangle, 1 without spatial splits.
    pub refs_per_tri: Option<f64>,
    /// Resident bytes of a process that has built the tree, beyond those before.
    pub bytes: Option<u64>,
    /// The same at the peak of the build.
    pub peak_bytes: Option<u64>,
    /// View, from 0, or [`ALL`].
    pub view: String,
    /// `phr`, `embree-native`, `embree-grafted` or [`NO_KERNEL`].
    pub kernel: String,
    /// `primary`, `shadow`, `bounce` or [`ALL`].
    pub ray_kind: String,
    /// Recorded rays traced.
    pub rays: Option<u64>,
    /// Time for these rays, median.
    pub trace_ms_median: Option<f64>,
    /// Time for these rays, median absolute deviation.
    pub trace_ms_mad: Option<f64>,
    /// Time for these rays, least.
    pub trace_ms_min: Option<f64>,
    /// Time for these rays, greatest.
    pub trace_ms_max: Option<f64>,
    /// Million rays per second, from the median.
    pub mrays_s: Option<f64>,
    /// Time for the whole path-traced frame, median; only where `ray_kind` is [`ALL`].
    pub frame_ms_median: Option<f64>,
    /// Time for the whole path-traced frame, median absolute deviation.
    pub frame_ms_mad: Option<f64>,
    /// Time for the whole path-traced frame, least.
    pub frame_ms_min: Option<f64>,
    /// Time for the whole path-traced frame, greatest.
    pub frame_ms_max: Option<f64>,
    /// Inner nodes visited per ray.
    pub node_visits_per_ray: Option<f64>,
    /// Leaf blocks of up to four triangles tested per ray.
    pub block_tests_per_ray: Option<f64>,
    /// Rays that hit.
    pub hits: Option<u64>,
    /// Hash of the rounded hit distances, hexadecimal.
    pub hit_hash: String,
    /// Answers of another triangle at the same distance.
    #[serde(default)]
    pub ties: Option<u64>,
    /// Answers that differ where only rounding decides: at an edge, an end of the ray, or at grazing incidence.
    #[serde(default)]
    pub edges: Option<u64>,
    /// Answers that exact arithmetic refutes, but single precision gives: on thin triangles.
    #[serde(default)]
    pub near_misses: Option<u64>,
    /// True if every hit agreed with the reference.
    pub verified: Option<bool>,
    /// Names of [`crate::bench::warnings::Warning`], separated by `;`.
    pub warnings: String,
    /// Why there is no figure; empty for a good row.
    pub error: String,
    /// The times of each round, in rows that sum over views and kinds of rays; kept in `rounds.csv`.
    #[serde(skip)]
    pub by_round: RowRounds,
}

impl Row {
    /// True for the row that sums over all views and ray kinds (or that tells of a build only).
    pub fn is_total(&self) -> bool {
        self.view == ALL && self.ray_kind == ALL
    }

    /// True for rows of the regime by which builders are compared: [`FRESH`], in older runs [`WARM`].
    pub fn is_compared(&self) -> bool {
        self.regime == FRESH || self.regime == WARM
    }

    /// True for rows of first builds.
    pub fn is_first(&self) -> bool {
        self.regime == FIRST || self.regime == COLD
    }

    /// The figures that are not counts, by column.
    fn figures(&self) -> [(&'static str, Option<f64>); 24] {
        [
            ("build_ms_median", self.build_ms_median),
            ("build_ms_mad", self.build_ms_mad),
            ("build_ms_min", self.build_ms_min),
            ("build_ms_max", self.build_ms_max),
            ("build_mtri_s", self.build_mtri_s),
            ("build_cpu_ns_per_tri", self.build_cpu_ns_per_tri),
            ("build_instructions_per_tri", self.build_instructions_per_tri),
            ("build_cycles_per_tri", self.build_cycles_per_tri),
            ("sah", self.sah),
            ("epo", self.epo),
            ("leaf_fill", self.leaf_fill),
            ("refs_per_tri", self.refs_per_tri),
            ("trace_ms_median", self.trace_ms_median),
            ("trace_ms_mad", self.trace_ms_mad),
            ("trace_ms_min", self.trace_ms_min),
            ("trace_ms_max", self.trace_ms_max),
            ("mrays_s", self.mrays_s),
            ("frame_ms_median", self.frame_ms_median),
            ("frame_ms_mad", self.frame_ms_mad),
            ("frame_ms_min", self.frame_ms_min),
            ("frame_ms_max", self.frame_ms_max),
            ("node_visits_per_ray", self.node_visits_per_ray),
            ("block_tests_per_ray", self.block_tests_per_ray),
            ("triangles", Some(self.triangles as f64)),
        ]
    }

    fn key(&self) -> RowKey {
        RowKey {
            run_id: self.run_id.clone(),
            scene: self.scene.clone(),
            builder: self.builder.clone(),
            width: self.width,
            threads: self.threads,
            regime: self.regime.clone(),
            kernel: self.kernel.clone(),
        }
    }

    /// True if the row holds figures that can be used.
    pub fn is_good(&self) -> bool {
        self.error.is_empty() && self.verified != Some(false)
    }

    /// True if the tree could not be traced by this kernel here, which is no fault of the tree.
    pub fn is_unavailable(&self) -> bool {
        self.error.starts_with(UNAVAILABLE)
    }

    /// The build times, if there are any.
    pub fn build_ms(&self) -> Option<Summary> {
        self.summary(self.build_figures())
    }

    /// The trace times, if there are any.
    pub fn trace_ms(&self) -> Option<Summary> {
        self.summary(self.trace_figures())
    }

    /// Inner nodes visited and leaf blocks tested per ray, if they were counted.
    pub fn steps(&self) -> Option<f64> {
        Some(self.node_visits_per_ray? + self.block_tests_per_ray?)
    }

    /// The frame times, if there are any.
    pub fn frame_ms(&self) -> Option<Summary> {
        self.summary(self.frame_figures())
    }

    /// Median, deviation, minimum and maximum.
    fn build_figures(&self) -> [Option<f64>; 4] {
        [self.build_ms_median, self.build_ms_mad, self.build_ms_min, self.build_ms_max]
    }

    fn trace_figures(&self) -> [Option<f64>; 4] {
        [self.trace_ms_median, self.trace_ms_mad, self.trace_ms_min, self.trace_ms_max]
    }

    fn frame_figures(&self) -> [Option<f64>; 4] {
        [self.frame_ms_median, self.frame_ms_mad, self.frame_ms_min, self.frame_ms_max]
    }

    fn summary(&self, [median, mad, min, max]: [Option<f64>; 4]) -> Option<Summary> {
        let count = self.rounds.max(1) as usize;
        Some(Summary { count, median: median?, mad: mad?, min: min?, max: max? })
    }
}

#[cfg(test)]
mod tests;
