//! Advice as CSV: one row per tree, with what was measured and what is made of it, so that an estimate that is made
//! otherwise needs no new measurement.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use super::estimate::{Traced, estimates};
use super::{Advice, Known};
use crate::bench::environment::{Machine, Program};
use crate::bench::files::{RecordsError, read_csv, write_csv};
use crate::bench::quick::line::{Estimate, TotalTime};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Version of the columns.
const SCHEMA: u32 = 2;
/// The file.
pub const ADVICE: &str = "advice.csv";

/// One tree, figures with the ends of their 95 % intervals.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct AdviceRow {
    /// Of these columns: 2.
    pub schema: u32,
    /// The scene.
    pub scene: String,
    /// Its triangles.
    pub triangles: usize,
    /// How the figures came about.
    pub origin: String,
    /// The builder.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// Visits behind the figures.
    pub rounds: usize,
    /// Build time, as measured.
    pub build_ms: Option<f64>,
    /// Lower end of its interval.
    pub build_ms_low: Option<f64>,
    /// Upper end of it.
    pub build_ms_high: Option<f64>,
    /// Time per ray, as measured.
    pub ns_per_ray: Option<f64>,
    /// Lower end of its interval.
    pub ns_per_ray_low: Option<f64>,
    /// Upper end of it.
    pub ns_per_ray_high: Option<f64>,
    /// Inner nodes that a ray visits.
    pub nodes_per_ray: Option<f64>,
    /// Time per ray, estimated from both in all trees.
    pub estimated_ns_per_ray: Option<f64>,
    /// Lower end of its interval.
    pub estimated_ns_per_ray_low: Option<f64>,
    /// Upper end of it.
    pub estimated_ns_per_ray_high: Option<f64>,
    /// The number of rays asked for.
    pub rays: f64,
    /// Build and so many rays.
    pub total_ms: Option<f64>,
    /// Lower end of its interval.
    pub total_ms_low: Option<f64>,
    /// Upper end of it.
    pub total_ms_high: Option<f64>,
    /// The number of rays from which on the tree is the best.
    pub best_from_rays: Option<f64>,
    /// Why there are no figures, or no further round.
    pub note: String,
    /// Revision of this program, `-dirty` if the sources differed from it; empty in files of older ones.
    #[serde(default)]
    pub git_rev: String,
    /// Processor model; likewise.
    #[serde(default)]
    pub cpu: String,
}

impl AdviceRow {
    /// What was measured of the tree.
    fn traced(&self) -> Option<Traced> {
        let estimate = |value, low: Option<f64>, high: Option<f64>| Estimate {
            value,
            low: low.unwrap_or(0.0),
            high: high.unwrap_or(f64::INFINITY),
        };
        Some(Traced {
            width: self.width,
            build_ms: estimate(self.build_ms?, self.build_ms_low, self.build_ms_high),
            ns_per_ray: estimate(self.ns_per_ray?, self.ns_per_ray_low, self.ns_per_ray_high),
            visits: self.rounds,
            nodes_per_ray: self.nodes_per_ray,
        })
    }
}

/// The total time of each tree of a scene, without its intervals, estimated again from what was measured.
pub fn lines(rows: &[AdviceRow]) -> Vec<Option<TotalTime>> {
    let traced: Vec<Option<Traced>> = rows.iter().map(AdviceRow::traced).collect();
    let mut estimates = estimates(&traced.iter().flatten().copied().collect::<Vec<_>>()).into_iter();
    let line = |traced: &Option<Traced>| {
        let line = traced.and_then(|_| estimates.next())?;
        Some(TotalTime::exact(line.build_ms.value, line.ns_per_ray.value))
    };
    traced.iter().map(line).collect()
}

/// Writes the advice to `folder`, whole or not at all.
///
/// # Errors
/// An unwritable place.
pub fn write(folder: &Path, advice: &Advice) -> Result<(), RecordsError> {
    let winners = advice.winners();
    let (git_rev, cpu) = (Program::this().git_rev, Machine::this("").cpu);
    let row = |known: &Known| {
        let is_this = |other: &&(&Known, f64)| std::ptr::eq(other.0, known);
        let built = known.traced.map(|traced| traced.build_ms);
        let [build_ms, build_ms_low, build_ms_high] = figures(built.or(known.line.map(|line| line.build_ms)));
        let estimated = known.line.map(|line| line.ns_per_ray);
        let measured = known.traced.map(|traced| traced.ns_per_ray).or(estimated);
        let [ns_per_ray, ns_per_ray_low, ns_per_ray_high] = figures(measured);
        let [estimated_ns_per_ray, estimated_ns_per_ray_low, estimated_ns_per_ray_high] = figures(estimated);
        let total = known.line.map(|line| line.estimate_at(advice.rays));
        let [total_ms, total_ms_low, total_ms_high] = figures(total);
        AdviceRow {
            schema: SCHEMA,
            scene: advice.scene.clone(),
            triangles: advice.triangles,
            origin: advice.origin.clone(),
            builder: known.builder.clone(),
            width: known.width,
            rounds: known.rounds,
            build_ms,
            build_ms_low,
            build_ms_high,
            ns_per_ray,
            ns_per_ray_low,
            ns_per_ray_high,
            nodes_per_ray: known.traced.and_then(|traced| traced.nodes_per_ray),
            estimated_ns_per_ray,
            estimated_ns_per_ray_low,
            estimated_ns_per_ray_high,
            rays: advice.rays,
            total_ms,
            total_ms_low,
            total_ms_high,
            best_from_rays: winners.iter().find(is_this).map(|(_, from)| *from),
            note: known.note.clone(),
            git_rev: git_rev.clone(),
            cpu: cpu.clone(),
        }
    };
    write_csv(&folder.join(ADVICE), &advice.trees.iter().map(row).collect::<Vec<_>>())
}

/// A figure and the ends of its interval; empty where nothing is known of one.
fn figures(estimate: Option<Estimate>) -> [Option<f64>; 3] {
    let finite = |value: f64| Some(value).filter(|value| value.is_finite() && *value > 0.0);
    estimate.map_or([None; 3], |it| [it.value, it.low, it.high].map(finite))
}

/// Reads the advice in the subfolders of `folder`, by name; that of the folder itself where none has any.
///
/// # Errors
/// No such file, other columns, no rows.
pub fn read_all(folder: &Path) -> Result<Vec<Vec<AdviceRow>>, RecordsError> {
    let schema = |row: &AdviceRow| row.schema;
    let read = |one: &PathBuf| read_csv(one, ADVICE, (schema, SCHEMA), "run `phr advise` first");
    with_file(folder, ADVICE).iter().map(read).collect()
}

/// The subfolders of `folder` that hold a file of this name, in order; the folder itself where none does.
pub(super) fn with_file(folder: &Path, name: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut folders: Vec<PathBuf> = entries.filter(|below| below.join(name).is_file()).collect();
    folders.sort();
    if folders.is_empty() {
        folders.push(folder.to_owned());
    }
    folders
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::advice::tests::advice;

    #[test]
    fn a_row_per_tree_with_what_is_known() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &advice()).unwrap();
        let path = folder.path().join(ADVICE);
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).unwrap();
        let header = reader.headers().unwrap().clone();
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let cell = |row: usize, column: &str| {
            let at = header.iter().position(|name| name == column).unwrap();
            rows[row][at].to_owned()
        };
        assert_eq!(rows.len(), 6);
        assert_eq!(cell(0, "builder"), "lbvh");
        assert!((cell(0, "total_ms").parse::<f64>().unwrap() - 10_010.0).abs() < 1e-6);
        assert_eq!(
            (cell(1, "best_from_rays"), cell(3, "best_from_rays")),
            ("500000.0".into(), String::new())
        );
        assert_eq!((cell(5, "build_ms"), cell(5, "note")), (String::new(), "no time".into()));
    }

    #[test]
    fn the_committed_advice_is_that_of_its_measurements() {
        let committed = read_all(Path::new("results/advice")).unwrap();
        let rows: Vec<&AdviceRow> = committed.iter().flatten().collect();
        let lines = committed.iter().flat_map(|rows| lines(rows));
        for (row, line) in rows.iter().zip(lines) {
            assert_eq!(line.is_some(), row.estimated_ns_per_ray.is_some(), "{row:?}");
            let (Some(line), Some(written)) = (line, row.estimated_ns_per_ray) else { continue };
            assert!((line.ns_per_ray.value / written - 1.0).abs() < 1e-6, "{line:?} {row:?}");
            assert!((line.at(row.rays) / row.total_ms.unwrap() - 1.0).abs() < 1e-6, "{line:?} {row:?}");
        }
        let counted = rows.iter().filter(|row| row.nodes_per_ray.is_some());
        assert!(counted.count() > rows.len() / 2);
    }
}
