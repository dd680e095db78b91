//! What all builders have in common: a trait, a finished build, its phases and counts.

use crate::builders::prims::boxes::Boxes;
use crate::builders::prims::geometry::Geometry;
use crate::bvh::{TriangleBlock, WideBvh};
use crate::geometry::Mesh;
use crate::memory::{self, OutOfMemory};
use crate::parallel::awake::Awake;
use crate::parallel::timeline;
use std::fmt;
use std::time::{Duration, Instant};

/// A named part of a build and how long it took on the wall clock.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Phase {
    /// What was done: "bounds", "presplit", "codes", "sort", "auxiliary tree", "cuts and nodes", ...
    pub name: &'static str,
    /// Wall-clock time.
    pub duration: Duration,
}

/// What a builder counted on the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Counts {
    /// Binary splits of cuts made; those within a subtree sweep are not counted.
    pub splits: u64,
    /// Splits that were spatial (paper 4.4).
    pub spatial_splits: u64,
    /// Cut nodes swept over, summed over the same splits.
    pub swept: u64,
}

/// A finished build of a tree of nodes of up to `N` children, 4 or 8.
#[derive(Clone, Debug)]
pub struct Build<const N: usize, B = TriangleBlock> {
    /// The tree with its leaf data.
    pub tree: WideBvh<N, B>,
    /// Durations, in order; they add up to the build.
    pub phases: Vec<Phase>,
    /// Counts.
    pub counts: Counts,
}

/// Builds a BVH of nodes of up to `N` children, 4 or 8. Builders are total: any [`Mesh`], empty ones included, has
/// a tree. They run on the rayon pool they are called from (`pool.install(|| builder.build(&mesh))`), and the tree
/// is the same at any number of threads. Until a build is over, idle threads of the pool look for work, a millisecond
/// at most, before they sleep; each of them is asked to, so none should be kept from the pool's work for ever. A thread
/// that waits for other work in that pool may take up parts of the build until it is over.
///
/// Builders of the list build over [`Boxes`] of anything, too:
/// [`over_boxes`](crate::builders::over_boxes).
///
/// A `Box<dyn Builder<8>>` may be kept where an engine keeps what threads share, a bevy resource for example: all that
/// is done with a shared one is to ask its name.
pub trait Builder<const N: usize, G: Geometry = Mesh>: Send + Sync {
    /// The name used in commands and records, e.g. `phr-fast`.
    fn name(&self) -> &str;

    /// The parameters as a JSON object, for the records; empty where a builder does not tell any.
    #[cfg(feature = "serde")]
    fn config(&self) -> serde_json::Value {
        serde_json::json!({})
    }

    /// Builds the tree over all triangles of a mesh, or all boxes. Temporary memory is kept for the next call.
    fn build(&mut self, geometry: &G) -> Build<N, G::Block>;

    /// The same where memory may not suffice: the large arrays are asked for, not taken for granted. Flags and
    /// short lists still end the process. Beside it, a plain `build` on another thread that fails so unwinds
    /// without a message.
    ///
    /// # Errors
    /// What there was no memory for. This builder is then of no use but to be dropped. A program compiled with
    /// `panic = "abort"` ends instead.
    fn try_build(&mut self, geometry: &G) -> Result<Build<N, G::Block>, OutOfMemory> {
        memory::catch_out_of_memory(|| self.build(geometry))
    }

    /// Gives back a tree that is no longer needed, so that the next one is built in its memory: fresh memory
    /// costs as much as a good part of a build.
    fn recycle(&mut self, tree: WideBvh<N, G::Block>);
}

impl<const N: usize> fmt::Debug for dyn Builder<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Builder").field(&self.name()).finish()
    }
}

/// A builder over boxes; as other builders it keeps its memory from build to build.
pub type BoxBuilder<const N: usize> = dyn for<'a> Builder<N, Boxes<'a>>;

impl<const N: usize, B> Build<N, B> {
    /// The whole build's duration: the sum of its phases.
    pub fn duration(&self) -> Duration {
        self.phases.iter().map(|phase| phase.duration).sum()
    }
}

/// Times consecutive phases, through which threads stay awake.
#[derive(Debug)]
pub(crate) struct Stopwatch {
    _awake: Awake,
    last: Instant,
    /// The phases so far.
    pub phases: Vec<Phase>,
}

impl Stopwatch {
    /// Starts the clock for a build over so many primitives.
    pub fn start(primitives: usize) -> Self {
        let last = Instant::now();
        Self { _awake: Awake::begin(primitives), last, phases: Vec::new() }
    }

    /// Ends a phase.
    pub fn lap(&mut self, name: &'static str) {
        let now = Instant::now();
        self.phases.push(Phase { name, duration: now - self.last });
        timeline::phase(name);
        self.last = now;
    }
}
