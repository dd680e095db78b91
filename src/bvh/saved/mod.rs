//! Trees in files: saved once, loaded in a fraction of the time of a build.
//!
//! The format is little-endian and laid out as in memory, so that a program may map it: a header of 128 bytes, the
//! nodes (128 bytes each, 256 of 8-wide trees: lower planes, upper planes, links, zeros up to a multiple of 64),
//! then the blocks of 160 bytes. Its second version:
//!
//! | bytes | content |
//! |:--|:--|
//! | 0 to 7 | `PHRTREE` and a zero |
//! | 8, 12 | version, children per node |
//! | 16, 20 | the root's link, a zero |
//! | 24, 32 | nodes, blocks |
//! | 40 to 63 | the box of everything: lower corner, upper corner |
//! | 64, 72 | fingerprint of the mesh, its triangles |
//! | 80 | of nodes, then blocks: the checksums of every 2048, one step each from 0 on |
//! | 88 | checksum of bytes 0 to 87, xor that of bytes 96 to 127 rotated left by a bit |
//! | 96 to 127 | name of the builder, zeros after it |
//!
//! A checksum of bytes is that of four sums, each of every fourth word of eight bytes. Checksums find damage, no
//! forgery; what a file says is checked before a kernel follows its links.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod header;
mod read;
mod replace;
mod write;

pub use header::Header;
pub(crate) use read::SavedTree;
pub use read::header_of;
#[cfg(feature = "harness")]
pub(crate) use replace::replace;

use super::validate::Invalid;
use crate::memory::OutOfMemory;
use std::path::{Path, PathBuf};

/// Records that are converted by a task, and have a checksum together.
/// So few that their bytes stay in a core's cache between the file and the tree.
const CHUNK: usize = 1 << 11;

/// Why a tree could not be saved or loaded: one line that names the file and the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SavedError {
    /// The file cannot be opened, read or written.
    #[error("{}: {source}; check the path and its permissions", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's message.
        source: std::io::Error,
    },
    /// No such file at all: a scene, perhaps.
    #[error("{}: {what}; give a file that `Bvh::save` or `phr build -o` wrote", path.display())]
    NotATree {
        /// The file.
        path: PathBuf,
        /// What it is not.
        what: &'static str,
    },
    /// A damaged file, or one of another version.
    #[error("{}: {what}; save the tree again", path.display())]
    Unusable {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// A tree of the other width.
    #[error("{}: a tree of {width} children per node, not {asked}; load it as one of {width}, or by `Bvh::load`", path.display())]
    OtherWidth {
        /// The file.
        path: PathBuf,
        /// Children per node in the file.
        width: u32,
        /// Those that were asked for.
        asked: u32,
    },
    /// More nodes or blocks than a tree of this crate's builders has.
    #[error("{}: {nodes} nodes and {blocks} leaf blocks, too many for its triangles; build the tree anew", path.display())]
    TooMany {
        /// The file.
        path: PathBuf,
        /// Inner nodes.
        nodes: u64,
        /// Leaf blocks.
        blocks: u64,
    },
    /// No memory for the tree.
    #[error("{}: {source}", path.display())]
    OutOfMemory {
        /// The file.
        path: PathBuf,
        /// What was asked for.
        source: OutOfMemory,
    },
    /// The tree of another mesh.
    #[error("{}: the tree of another mesh ({triangles} triangles, {mesh:016x}); give its scene or save the tree again", path.display())]
    OtherMesh {
        /// The file.
        path: PathBuf,
        /// Triangles of its mesh.
        triangles: u64,
        /// [`Mesh::fingerprint`](crate::geometry::Mesh::fingerprint) of its mesh.
        mesh: u64,
    },
    /// A tree to be saved for a mesh that is not its own.
    #[error("{}: the tree is of another mesh, or the mesh was moved since; give that which it was built over", path.display())]
    NotOfMesh {
        /// Where it was to be saved.
        path: PathBuf,
    },
    /// The links do not form a tree over the mesh.
    #[error("{}: {source}; build the tree again, and save that", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// The first flaw.
        source: Invalid,
    },
}

impl SavedError {
    fn unusable(path: &Path, what: impl Into<String>) -> Self {
        Self::Unusable { path: path.to_owned(), what: what.into() }
    }

    fn not_a_tree(path: &Path, what: &'static str) -> Self {
        Self::NotATree { path: path.to_owned(), what }
    }

    pub(crate) fn invalid(path: &Path) -> impl Fn(Invalid) -> Self {
        move |source| match source {
            Invalid::OutOfMemory(source) => Self::OutOfMemory { path: path.to_owned(), source },
            source => Self::Invalid { path: path.to_owned(), source },
        }
    }

    fn io(path: &Path) -> impl Fn(std::io::Error) -> Self {
        move |source| Self::Io { path: path.to_owned(), source }
    }
}

#[cfg(test)]
mod tests;
