//! Builders: from an indexed mesh to a traversable [`Bvh4`].

mod aac;
mod binary;
mod bins;
mod collapse;
mod cut;
mod cut_recursion;
mod hierarchy;
mod hunt;
mod in_order;
mod lanes;
mod lbvh;
mod linear;
mod morton;
mod morton_order;
mod object_split;
mod pages;
mod phr;
mod piece;
#[cfg(test)]
mod plain;
mod prefetch;
mod presplit;
mod radix_sort;
mod reference_split;
mod references;
mod run;
mod small_sweep;
mod spatial_bound;
mod spatial_split;
mod split_cost;
mod top_down;
mod upper;

pub use aac::{Aac, AacConfig};
pub use linear::Lbvh;
pub use hunt::{Hunt, HuntConfig};
pub use phr::{Phr, PhrConfig};
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

/// Names of all builders, in the order of the table.
pub const NAMES: &[&str] = &["lbvh", "hunt-50", "hunt-500", "aac", "phr-fast", "phr-hq"];

/// The builder called `name`, or `None`; names are those of [`NAMES`].
pub fn by_name(name: &str) -> Option<Box<dyn Builder>> {
    Some(match name {
        "lbvh" => Box::new(Lbvh::default()),
        "hunt-50" => Box::new(Hunt::new("hunt-50", HuntConfig { cut_length: 50, max_leaf: 8 })),
        "hunt-500" => Box::new(Hunt::new("hunt-500", HuntConfig { cut_length: 500, max_leaf: 8 })),
        "aac" => Box::new(Aac::new(AacConfig::FAST)),
        "phr-fast" => Box::new(Phr::new("phr-fast", PhrConfig::FAST)),
        n if n.starts_with("x:") => {
            // x:alpha:delta:max_leaf:leaf_sweep:spatial:auxleaf
            let f: Vec<f32> = n[2..].split(':').map(|x| x.parse().unwrap()).collect();
            Box::new(Phr::new("x", PhrConfig { alpha: f[0], delta: f[1], max_leaf: f[2] as u32, leaf_sweep: f[3] as u32, spatial_threshold: f[4], auxiliary_leaf: f[5] as u32, presplit: (f[6] > 0.0).then_some(PresplitConfig::NEEDLES), clip_triangles: f[7] > 0.0, ..PhrConfig::FAST }))
        }
        "phr-hq" => Box::new(Phr::new("phr-hq", PhrConfig::HQ)),
        _ => return None,
    })
}
