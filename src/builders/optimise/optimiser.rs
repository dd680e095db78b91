//! The passes of the optimisation, and their memory.

use super::collapsed::CollapsedTree;
use super::config::OptimiseConfig;
use super::record::RecordedChunk;
use super::reinsertion::Reinsertion;
use super::tree::{ROOT, Tree};
use crate::builders::api::builder::Stopwatch;
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

    /// The optimised wide tree over `geometry`, of the splits of a recursion below its initial cut.
    pub fn build<P: CutPolicy, G: Geometry<Block = B>>(
        &mut self,
        (recursion, cut): (CutRecursion<'_, P, G>, Option<OwnedCut>),
        geometry: &G,
        of_cuts: &Memory<CutScratch, N, B>,
        config: &OptimiseConfig,
        watch: &mut Stopwatch,
    ) -> WideBvh<N, B> {
        let Self { tree, chunks, reinsertion, choices, memory } = self;
        let is_empty = !cut.is_some_and(|cut| tree.record(&recursion, cut, geometry, of_cuts, chunks));
        watch.lap("cuts and nodes");
        if is_empty {
            return WideBvh::default();
        }
        let wanted = (tree.pairs.len() as f32 * config.share) as usize;
        reinsertion.run(tree, config.rounds, wanted);
        watch.lap("reinsertion");
        choices.solve::<_, N>(tree, ROOT, tree.pairs.len(), &config.costs, true);
        let wide = build::build_known(&CollapsedTree::new(tree, choices), ROOT, geometry, memory);
        watch.lap("collapse");
        wide
    }
}
