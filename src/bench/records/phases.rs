//! `phases.csv`: what the parts of each build took. `results/README.md` describes the columns.

use super::files::{MEASURE, RecordsError, read_csv_file, write_csv};
use super::samples::{CellSamples, Samples};
use super::statistics::{Summary, figures};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The file in a results folder; there is none where no builder tells of its phases.
pub const PHASES: &str = "phases.csv";

/// A phase of a tree's builds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseRow {
    /// Names the run.
    pub run_id: String,
    /// Scene name.
    pub scene: String,
    /// Triangles built over.
    pub triangles: u64,
    /// Builder name.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// Place among the phases of the build, from 0.
    pub place: u32,
    /// What was done, as "codes", "sort" or "cuts and nodes".
    pub phase: String,
    /// Its time in the last fresh build of each round, median over rounds, ms.
    pub ms: f64,
}

/// The phases of all cells.
pub fn of_samples(samples: &Samples) -> Vec<PhaseRow> {
    let mut rows = Vec::new();
    for scene in &samples.scenes {
        for cell in &scene.cells {
            rows.extend(medians(cell).into_iter().zip(0..).map(|((phase, ms), place)| PhaseRow {
                run_id: samples.run_id.clone(),
                scene: scene.name.clone(),
                triangles: scene.triangles,
                builder: cell.cell.builder.clone(),
                width: cell.cell.width,
                place,
                phase,
                ms: figures(ms),
            }));
        }
    }
    rows
}

/// The phases of a cell in their order, with the median of their times; phases of one name are one.
fn medians(cell: &CellSamples) -> Vec<(String, f64)> {
    let mut all: Vec<(String, Vec<f64>)> = Vec::new();
    for (visit, samples) in cell.visits.iter().enumerate() {
        for (phase, ms) in &samples.builds.phases {
            if !all.iter().any(|(known, _)| known == phase) {
                all.push((phase.clone(), Vec::new()));
            }
            let known = all.iter_mut().find(|(known, _)| known == phase);
            if let Some((_, times)) = known {
                times.resize(visit + 1, 0.0);
                if let Some(time) = times.last_mut() {
                    *time += ms;
                }
            }
        }
    }
    let median = |(phase, times): (String, Vec<f64>)| Some((phase, Summary::of(&times)?.median));
    all.into_iter().filter_map(median).collect()
}

/// Writes the phases to `folder`; where there are none, an older file is removed.
///
/// # Errors
/// An unwritable place.
pub fn write(folder: &Path, rows: &[PhaseRow]) -> Result<(), RecordsError> {
    let path = folder.join(PHASES);
    if !rows.is_empty() {
        return write_csv(&path, rows);
    }
    match std::fs::remove_file(&path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(RecordsError::Io { path, source, remedy: "remove it, or give another folder with --out" })
        }
        _ => Ok(()),
    }
}

/// Reads the phases beside the rows in the folder, or beside the file, `path`; none of runs that have no such file.
///
/// # Errors
/// A malformed, cut or empty file, and figures that cannot be.
pub fn read(path: &Path) -> Result<Vec<PhaseRow>, RecordsError> {
    let path = if path.is_dir() { path.join(PHASES) } else { path.with_file_name(PHASES) };
    if path.is_file() { read_csv_file(&path, MEASURE) } else { Ok(Vec::new()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::build_times::BuildTimes;
    use crate::bench::cell::Cell;
    use crate::bench::samples::VisitSamples;
    use crate::bench::tree_facts::TreeFacts;

    #[test]
    fn phases_are_medians_over_rounds_and_read_back() {
        let visit = |round: usize, sort: f64| {
            let phases = [("codes", 1.0), ("sort", sort), ("codes", 0.5)];
            let phases = phases.iter().map(|(name, ms)| ((*name).to_owned(), *ms)).collect();
            let builds = BuildTimes { phases, ..BuildTimes::default() };
            VisitSamples { round, place: 0, builds, timings: Vec::new(), cpu_time: Default::default() }
        };
        let cell = CellSamples {
            cell: Cell::new("lbvh", 4, &[]),
            facts: TreeFacts::default(),
            checks: Vec::new(),
            visits: vec![visit(0, 2.0), visit(1, 9.0), visit(2, 3.0)],
            memory: None,
            error: None,
        };
        assert_eq!(medians(&cell), [("codes".to_owned(), 1.5), ("sort".to_owned(), 3.0)]);

        let folder = tempfile::tempdir().unwrap();
        assert_eq!(read(folder.path()).unwrap(), []);
        let rows = [PhaseRow { scene: "s".into(), phase: "sort".into(), ms: 3.0, ..PhaseRow::default() }];
        write(folder.path(), &rows).unwrap();
        assert_eq!(read(folder.path()).unwrap(), rows);
        assert_eq!(read(&folder.path().join("rows.csv")).unwrap(), rows);
        let path = folder.path().join(PHASES);
        let whole = std::fs::read_to_string(&path).unwrap();
        for ms in ["NaN", "inf", "1e308", "-1"] {
            std::fs::write(&path, whole.replace("3.0", ms)).unwrap();
            let error = read(folder.path()).unwrap_err().to_string();
            assert!(error.contains("line 2: ms is "), "{error}");
        }
        // A name may look like a number.
        std::fs::write(&path, whole.replace(",s,", ",inf,")).unwrap();
        assert_eq!(read(folder.path()).unwrap()[0].scene, "inf");
        write(folder.path(), &[]).unwrap();
        assert!(!path.exists(), "an older file is not mistaken for this run's");
    }
}
