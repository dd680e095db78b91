//! The records of programs measured by turns: `turns.csv`, one row per session x builder x width x scene.
//! `results/README.md` describes the columns for readers of the file.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]

use crate::bench::files::{self, RecordsError};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the columns; a reader refuses any other.
pub const SCHEMA: u32 = 1;
/// The file in a results folder.
pub const TURNS: &str = "turns.csv";

/// One line of `turns.csv`: a session.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TurnRow {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Start of the comparison, ISO 8601.
    pub utc: String,
    /// Revision of the program before, `-dirty` if its sources differed from it; empty of one that does not tell.
    pub before_rev: String,
    /// Revision of the program after, likewise.
    pub after_rev: String,
    /// Processor model.
    pub cpu: String,
    /// Threads of the builds.
    pub threads: u32,
    /// Scene name.
    pub scene: String,
    /// Builder.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// The session, from 1.
    pub session: u32,
    /// Build time before, ms: the median of the session's rounds.
    pub before_ms: f64,
    /// Build time after, likewise.
    pub after_ms: f64,
    /// Time after over time before: the median of the rounds' ratios.
    pub ratio: f64,
}

impl TurnRow {
    /// The builder at its width.
    pub fn tree(&self) -> (&str, u32) {
        (&self.builder, self.width)
    }
}

/// Writes the rows, whole.
///
/// # Errors
/// An unwritable place.
pub fn write(path: &Path, rows: &[TurnRow]) -> Result<(), RecordsError> {
    files::write_csv(path, rows)
}

/// Reads the rows of a results folder or of a file.
///
/// # Errors
/// No such file, other columns, no rows.
pub fn read(results: &Path) -> Result<Vec<TurnRow>, RecordsError> {
    let remedy = "run `phr compare --against BINARY SCENE... --out DIR` first";
    files::read_csv(results, TURNS, (|row: &TurnRow| row.schema, SCHEMA), remedy)
}
