//! The memory of builders over cuts, kept from build to build, and what they count.

use super::cut::Side;
use crate::builders::api::builder::{Build, Counts, Stopwatch};
use crate::builders::binary::node::Node;
use crate::builders::binary::subtrees::Subtrees;
use crate::builders::lbvh::auxiliary::Auxiliary;
use crate::builders::split::object::strategy::ObjectSweep;
use crate::builders::split::spatial::strategy::SpatialSweep;
use crate::builders::split::subtree_sweep::SubtreeSweep;
use crate::builders::wide::memory::{Memory, Scratch};
use crate::builders::wide::optimal::Choices;
use crate::bvh::{TriangleBlock, WideBvh};

/// A thread's memory.
#[derive(Default)]
pub(crate) struct CutScratch {
    /// What was counted since it was last taken.
    pub counts: Counts,
    /// The nodes of all cuts in use.
    pub arena: Vec<Node>,
    /// For object splits.
    pub object: ObjectSweep,
    /// For spatial splits.
    pub spatial: SpatialSweep,
    /// The sides of the split that is made.
    pub sides: [Side; 2],
    /// For cuts split down to their leaves in one go.
    pub subtree_sweep: SubtreeSweep,
    /// Those cuts, split.
    pub subtrees: Subtrees,
    /// For subtrees that are collapsed to the cheapest wide tree.
    pub choices: Choices,
    /// Triangles of one of their leaves.
    pub prims: Vec<u32>,
}

impl Scratch for CutScratch {
    type Checkpoint = (usize, [usize; 2]);

    fn checkpoint(&self) -> Self::Checkpoint {
        (self.arena.len(), self.subtrees.checkpoint())
    }

    fn rollback(&mut self, (arena, subtrees): Self::Checkpoint) {
        self.arena.truncate(arena);
        self.subtrees.rollback(subtrees);
    }
}

/// The memory of a builder over cuts.
pub(crate) struct CutMemory<const N: usize, B = TriangleBlock> {
    /// The auxiliary BVH.
    pub auxiliary: Auxiliary,
    /// Of the recursion.
    pub recursion: Memory<CutScratch, N, B>,
}

impl<const N: usize, B> Default for CutMemory<N, B> {
    fn default() -> Self {
        Self { auxiliary: Auxiliary::default(), recursion: Memory::default() }
    }
}

impl<const N: usize, B> CutMemory<N, B> {
    /// Puts a build together.
    pub fn finish(&mut self, tree: WideBvh<N, B>, Stopwatch { phases, .. }: Stopwatch) -> Build<N, B> {
        let mut counts = Counts::default();
        self.recursion.workers.for_each(|worker| {
            let of_thread = std::mem::take(&mut worker.scratch.counts);
            counts.splits += of_thread.splits;
            counts.spatial_splits += of_thread.spatial_splits;
            counts.swept += of_thread.swept;
        });
        Build { tree, phases, counts }
    }
}
