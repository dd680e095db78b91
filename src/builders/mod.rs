//! Builders: from an indexed mesh to a traversable [`Bvh4`].

mod aac;
mod areas;
mod axes;
mod best;
mod binary;
mod bins;
mod cheapest;
mod collapse;
mod cut;
mod cut_recursion;
mod heights;
mod hierarchy;
mod hunt;
mod in_order;
mod initial_cut;
mod known_splits;
// Vectors are written for x86-64 so far; elsewhere all cuts are sorted or binned.
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod lane_cost;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod lanes;
mod lbvh;
mod linear;
mod morton;
mod morton_order;
mod near_leaves;
mod needle;
mod object_split;
mod optimise;
mod pages;
mod phr;
mod piece;
#[cfg(test)]
mod plain;
mod prefetch;
mod presets;
mod presplit;
mod radix_sort;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod rank_sweep;
mod reference_split;
mod references;
mod rules;
mod run;
mod same_code;
mod settled;
mod side;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod small_sweep;
mod spatial_bound;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod spatial_lanes;
mod spatial_split;
mod split_cost;
#[doc(hidden)]
pub mod steps;
mod stream;
mod subtree_sweep;
mod subtrees;
mod top_down;
mod upper;
mod waiting;
mod wide_run;
mod widen;

pub use aac::{Aac, AacConfig};
pub use best::{Best, BestConfig};
pub use hunt::{Hunt, HuntConfig};
pub use lbvh::Clusters;
pub use linear::Lbvh;
pub use optimise::{Costs, OptimiseConfig};
pub use phr::{OwnThreshold, Phr, PhrConfig};
pub use presets::{ABLATION, NAMES, by_name};
pub use presplit::PresplitConfig;

use crate::bvh::Bvh4;
use crate::geometry::Mesh;
use std::time::{Duration, Instant};

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

    /// Gives back a tree that is no longer needed, so that the next one is built in its memory: fresh memory
    /// costs as much as a good part of a build.
    fn recycle(&mut self, tree: Bvh4);
}

impl Build {
    /// Puts a build together; `temporary` is what the builder held beside the tree, bytes.
    fn finish(tree: Bvh4, phases: Vec<Phase>, counts: Counts, temporary: usize) -> Self {
        let peak_bytes = (temporary + tree.bytes()) as u64;
        Self { tree, phases, counts: Counts { peak_bytes, ..counts } }
    }

    /// The whole build's duration: the sum of its phases.
    pub fn duration(&self) -> Duration {
        self.phases.iter().map(|phase| phase.duration).sum()
    }
}

/// Times consecutive phases.
struct Stopwatch {
    last: Instant,
    phases: Vec<Phase>,
}

impl Stopwatch {
    fn start() -> Self {
        Self { last: Instant::now(), phases: Vec::new() }
    }

    fn lap(&mut self, name: &'static str) {
        let now = Instant::now();
        self.phases.push(Phase { name, duration: now - self.last });
        self.last = now;
    }
}
