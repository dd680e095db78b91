//! The records of scaling: `scaling.csv`, one row per scene x builder x width x workers x phase.
//! `results/README.md` describes the columns for readers of the file.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use crate::bench::files::{self, RecordsError};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the columns; a reader refuses any other.
pub const SCHEMA: u32 = 1;
/// The file in a results folder.
pub const SCALING: &str = "scaling.csv";
/// The phase of the row that is about the whole build.
pub const ALL: &str = "all";

/// One line of `scaling.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ScalingRow {
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
    /// Builder.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// Workers of the schedule.
    pub workers: u32,
    /// Part of the build, or [`ALL`].
    pub phase: String,
    /// Rounds behind the figures.
    pub rounds: u32,
    /// Milliseconds of work of all tasks, one thread alone: median over rounds, as are the others.
    pub work_ms: f64,
    /// Milliseconds of the critical path.
    pub span_ms: f64,
    /// Milliseconds of the greedy schedule.
    pub scheduled_ms: f64,
    /// Milliseconds of builds on so many threads, on the whole build's row where the machine has them.
    pub measured_ms: Option<f64>,
}

/// Writes the rows, whole.
///
/// # Errors
/// An unwritable place.
pub fn write(path: &Path, rows: &[ScalingRow]) -> Result<(), RecordsError> {
    files::write_csv(path, rows)
}

/// Reads the rows of a results folder or of a file.
///
/// # Errors
/// No such file, other columns, no rows.
pub fn read(results: &Path) -> Result<Vec<ScalingRow>, RecordsError> {
    files::read_csv(results, SCALING, (|row: &ScalingRow| row.schema, SCHEMA), "run `phr scaling` first")
}
