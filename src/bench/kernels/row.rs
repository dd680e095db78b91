//! The records of kernels: `kernels.csv`, one row per scene x builder x width x kernel x ray kind x threads.
//! `results/README.md` describes the columns for readers of the file.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use crate::bench::files::{self, MOST, RecordsError};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the columns; a reader refuses any other.
pub const SCHEMA: u32 = 1;
/// The file in a results folder.
pub const KERNELS: &str = "kernels.csv";
/// The kernel that the others are compared with.
pub const SINGLE: &str = "embree-single";
/// Embree's watertight kernel.
pub const ROBUST: &str = "embree-robust";
/// Ours.
pub const WATERTIGHT: &str = "phr-watertight";
/// Our kernel without vector instructions.
pub const PORTABLE: &str = "phr-portable";

/// Whether a kernel tests triangles by other arithmetic than [`SINGLE`], so that more of its answers differ at edges.
pub fn rounds_otherwise(kernel: &str) -> bool {
    [ROBUST, WATERTIGHT, PORTABLE].contains(&kernel)
}

/// One line of `kernels.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KernelRow {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Start of the run, ISO 8601.
    pub utc: String,
    /// Revision of this program, `-dirty` if the sources differed from it.
    pub git_rev: String,
    /// Processor model.
    pub cpu: String,
    /// Scene name.
    pub scene: String,
    /// Triangles.
    pub triangles: u64,
    /// Who built the tree.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// Who traced the rays, and how.
    pub kernel: String,
    /// The kernel's instruction set.
    pub isa: String,
    /// "primary", "shadow" or "bounce".
    pub ray_kind: String,
    /// Rays per pass.
    pub rays: u64,
    /// Threads.
    pub threads: u32,
    /// Rounds behind the figures.
    pub rounds: u32,
    /// Million rays per second, from the median round.
    pub mrays_s: f64,
    /// Speed relative to [`SINGLE`] over the same tree, from the medians; empty where Embree has not traced the tree.
    pub ratio: Option<f64>,
    /// Lower end of the ratio's 95 % interval.
    pub ratio_low: Option<f64>,
    /// Upper end of it.
    pub ratio_high: Option<f64>,
    /// Whether all answers agree with those of the reference, Embree's single rays over the first tree: none is
    /// wrong, and no more than may be differ at edges or on thin triangles.
    pub verified: bool,
    /// Answers that differ where only rounding decides.
    pub edges: Option<u64>,
    /// Answers that exact arithmetic refutes, but single precision gives.
    pub near_misses: Option<u64>,
    /// Milliseconds of each pass, with spaces between them.
    pub pass_ms: String,
}

impl KernelRow {
    /// True of our kernels.
    pub fn is_ours(&self) -> bool {
        self.kernel.starts_with("phr")
    }

    /// Milliseconds of each pass.
    pub fn passes(&self) -> Vec<f64> {
        self.pass_ms.split_whitespace().filter_map(|ms| ms.parse().ok()).collect()
    }
}

/// Writes the rows, whole.
///
/// # Errors
/// An unwritable place.
pub fn write(path: &Path, rows: &[KernelRow]) -> Result<(), RecordsError> {
    files::write_csv(path, rows)
}

/// Reads the rows of a results folder or of a file.
///
/// # Errors
/// No such file, other columns, no rows.
pub fn read(results: &Path) -> Result<Vec<KernelRow>, RecordsError> {
    let remedy = "run `phr kernels` first";
    let rows = files::read_csv(results, KERNELS, (|row: &KernelRow| row.schema, SCHEMA), remedy)?;
    for (row, line) in rows.iter().zip(2..) {
        let of = |pass: &str| pass.parse().unwrap_or(f64::NAN);
        let is_one = |ms: &f64| (0.0..=MOST).contains(ms);
        if let Some(value) = row.pass_ms.split_whitespace().map(of).find(|ms| !is_one(ms)) {
            let path = if results.is_dir() { results.join(KERNELS) } else { results.to_owned() };
            return Err(RecordsError::Figure { path, line, column: "pass_ms".into(), value, remedy });
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_as_written() {
        let folder = tempfile::tempdir().unwrap();
        let row = KernelRow {
            schema: SCHEMA,
            scene: "rooms".into(),
            mrays_s: 3.25,
            ratio: Some(1.5),
            edges: Some(2),
            pass_ms: "1.5 2".into(),
            ..KernelRow::default()
        };
        assert_eq!(row.passes(), [1.5, 2.0]);
        let rows = [row.clone(), KernelRow { ratio: None, verified: true, ..row }];
        write(&folder.path().join(KERNELS), &rows).unwrap();
        assert_eq!(read(folder.path()).unwrap(), rows);
    }

    #[test]
    fn passes_that_cannot_be_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for pass_ms in ["1.5 -2", "NaN", "1.5 two"] {
            let row = KernelRow { schema: SCHEMA, pass_ms: pass_ms.into(), ..KernelRow::default() };
            write(&folder.path().join(KERNELS), &[row]).unwrap();
            let error = read(folder.path()).unwrap_err().to_string();
            assert!(error.contains("kernels.csv") && error.contains("pass_ms"), "{error}");
        }
    }

    #[test]
    fn other_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = read(folder.path()).unwrap_err().to_string();
        assert!(error.contains(KERNELS) && error.contains("phr kernels"), "{error}");
        write(&folder.path().join(KERNELS), &[KernelRow { schema: 7, ..KernelRow::default() }]).unwrap();
        assert!(matches!(read(folder.path()), Err(RecordsError::Schema { found: 7, .. })));
    }
}
