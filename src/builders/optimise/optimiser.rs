//! The passes of the optimisation, and their memory.

use super::collapsed::CollapsedTree;
use super::config::OptimiseConfig;
use super::record::RecordedChunk;
use super::reinsertion::Reinsertion;
use super::tree::{ROOT, Tree};
use crate::builders::api::builder::Stopwatch;
use crate::builders::binary::subtrees::Subtrees;
use crate::builders::phr::cut::OwnedCut;
use crate::builders::phr::memory::CutScratch;
use crate::builders::phr::policy::CutPolicy;
use crate::builders::phr::recursion::CutRecursion;
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::build;
use crate::builders::wide::memory::Memory;
use crate::builders::wide::optimal::Choices;
use crate::bvh::{TriangleBlock, WideBvh};
use crate::memory::pool::Pool;

/// The binary tree and the memory of the passes, kept from build to build.
pub(crate) struct Optimiser<const N: usize, B = TriangleBlock> {
    tree: Tree,
    chunks: Pool<RecordedChunk>,
    reinsertion: Reinsertion,
    choices: Choices,
    memory: Memory<(), N, B>,
}

impl<const N: usize, B> Default for Optimiser<N, B> {
    fn default() -> Self {
        Self {
            tree: Tree::default(),
            chunks: Pool::default(),
            reinsertion: Reinsertion::default(),
            choices: Choices::default(),
            memory: Memory::default(),
        }
    }
}

impl<const N: usize, B> Optimiser<N, B> {
    /// Takes a tree whose memory the next one may use.
    pub fn recycle(&mut self, tree: WideBvh<N, B>) {
        self.memory.recycle(tree);
    }

    /// Records the binary tree of the splits of `recursion` over `geometry` below `root`; returns whether there is one.
    pub fn record<P: CutPolicy, G: Geometry<Block = B>>(
        &mut self,
        recursion: &CutRecursion<'_, P, G>,
        root: Option<(OwnedCut, Subtrees)>,
        geometry: &G,
        memory: &Memory<CutScratch, N, B>,
    ) -> bool {
        root.is_some_and(|root| self.tree.record(recursion, root, geometry, memory, &self.chunks))
    }

    /// The optimised wide tree over `geometry`.
    pub fn improve<G: Geometry<Block = B>>(
        &mut self,
        geometry: &G,
        config: &OptimiseConfig,
        watch: &mut Stopwatch,
    ) -> WideBvh<N, B> {
        let Self { tree, reinsertion, choices, memory, .. } = self;
        let wanted = (tree.pairs.len() as f32 * config.share) as usize;
        reinsertion.run(tree, config.rounds, wanted);
        watch.lap("reinsertion");
        choices.solve::<_, N>(tree, ROOT, tree.pairs.len(), &config.costs, true);
        let wide = build::build(&CollapsedTree::new(tree, choices), Some(ROOT), geometry, memory);
        watch.lap("collapse");
        wide
    }
}
