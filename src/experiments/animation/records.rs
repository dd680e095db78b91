//! The records of an animation: `animation.csv`, a row for each frame of each contestant. `results/README.md`
//! describes the columns for readers of the file.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use super::entrant::{Entrant, Update};
use crate::bench::files::{self, RecordsError};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the columns; a reader refuses any other.
pub const SCHEMA: u32 = 1;
/// The file in a results folder.
pub const ANIMATION: &str = "animation.csv";

/// One line of `animation.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameRow {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Start of the run, ISO 8601.
    pub utc: String,
    /// Revision of this program, `-dirty` if the sources differed from it.
    pub git_rev: String,
    /// Processor model.
    pub cpu: String,
    /// Threads of each side.
    pub threads: u32,
    /// Scene name.
    pub scene: String,
    /// Triangles.
    pub triangles: u64,
    /// Triangles that never move.
    pub fixed: u64,
    /// Frames of the animation.
    pub frames: u32,
    /// The frame, from 0.
    pub frame: u32,
    /// Builder.
    pub builder: String,
    /// How its tree follows the scene.
    pub update: Update,
    /// Children per node.
    pub width: u32,
    /// Kernel of the traces.
    pub kernel: String,
    /// Pixels across and down.
    pub size: u32,
    /// Views.
    pub views: u32,
    /// Times that the frame was updated and traced.
    pub rounds: u32,
    /// Rays traced.
    pub rays: u64,
    /// Milliseconds to bring the tree up to date: median over rounds. In frame 0 it is built, in every way.
    pub build_ms: Option<f64>,
    /// Milliseconds to trace all rays: median over rounds.
    pub trace_ms: Option<f64>,
    /// SAH cost of the tree.
    pub sah: Option<f64>,
    /// Steps of a ray, node visits and block tests, under our kernel: what traces take, without noise.
    pub steps: Option<f64>,
    /// Whether all hits are those of the reference in this frame.
    pub verified: bool,
    /// Why there are no figures.
    pub error: String,
}

impl FrameRow {
    /// Whose row it is.
    pub fn entrant(&self) -> Entrant {
        Entrant { builder: self.builder.clone(), update: self.update, recipe: None }
    }
}

/// Writes the rows, whole.
///
/// # Errors
/// An unwritable place.
pub fn write(path: &Path, rows: &[FrameRow]) -> Result<(), RecordsError> {
    files::write_csv(path, rows)
}

/// Reads the rows of a results folder or of a file.
///
/// # Errors
/// No such file, other columns, no rows.
pub fn read(results: &Path) -> Result<Vec<FrameRow>, RecordsError> {
    files::read_csv(results, ANIMATION, (|row: &FrameRow| row.schema, SCHEMA), "run `phr animate` first")
}
