//! Builders: from an indexed mesh to a traversable [`Bvh4`].

use crate::bvh::Bvh4;
use crate::geometry::Mesh;
use std::time::Duration;

/// A named part of a build and how long it took on the wall clock.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Phase {
    /// What was done: "boxes", "codes", "sort", "auxiliary tree", "cuts", ...
    pub name: &'static str,
    /// Wall-clock time.
    pub duration: Duration,
}

/// What a builder counted on the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Counts {
    /// Binary splits made.
    pub splits: u64,
    /// Splits that were spatial (paper 4.4).
    pub spatial_splits: u64,
    /// Cut nodes swept over, summed over all splits.
    pub swept: u64,
    /// Nodes of the auxiliary tree.
    pub auxiliary_nodes: u64,
    /// Bytes held at the peak, temporaries and tree together.
    pub peak_bytes: u64,
}

/// A finished build.
#[derive(Clone, Debug)]
pub struct Build {
    /// The tree with its leaf data.
    pub tree: Bvh4,
    /// Durations, in order; they add up to the build.
    pub phases: Vec<Phase>,
    /// Counts.
    pub counts: Counts,
}

/// Builds a BVH. Builders are total: any [`Mesh`], empty ones included, has a tree. They run on the rayon
/// pool they are called from (`pool.install(|| builder.build(&mesh))`), and the tree is the same at any
/// number of threads.
pub trait Builder: Send {
    /// The name used in commands and records, e.g. `phr-fast`.
    fn name(&self) -> &'static str;

    /// The parameters, for the records.
    fn config(&self) -> serde_json::Value;

    /// Builds the tree over all triangles of `mesh`. Temporary memory is kept for the next call.
    fn build(&mut self, mesh: &Mesh) -> Build;
}

/// Names of all builders, in the order of the table.
pub const NAMES: &[&str] = &["lbvh", "phr-fast", "phr-hq"];

/// The builder called `name`, or `None`; names are those of [`NAMES`].
pub fn by_name(name: &str) -> Option<Box<dyn Builder>> {
    let _ = name;
    None
}
