//! Bytes of a build, by one instrument for all contenders: the resident memory of a process that builds once.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod child;
mod mesh_stream;
mod parent;

pub use child::answer;
pub use parent::measure;

use serde::{Deserialize, Serialize};

/// Resident bytes of a process that has loaded a mesh and then builds its tree, beyond those before the build.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BuildMemory {
    /// At the peak of the build.
    pub peak_bytes: u64,
    /// After it, with the tree alone alive.
    pub live_bytes: u64,
}
