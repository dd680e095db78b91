//! The passes of the optimisation, and their memory.

use super::config::OptimiseConfig;
use super::emit::CollapsedTree;
use super::record::RecordedChunk;
use super::reinsertion::Reinsertion;
use super::tree::{ROOT, Tree};
use crate::builders::binary::subtrees::Subtrees;
use crate::builders::builder::Stopwatch;
use crate::builders::phr::cut::OwnedCut;
use crate::builders::phr::memory::CutScratch;
use crate::builders::phr::policy::CutPolicy;
use crate::builders::phr::recursion::CutRecursion;
use crate::builders::wide::build;
use crate::builders::wide::memory::Memory;
use crate::builders::wide::optimal::Choices;
use crate::bvh::WideBvh;
use crate::geometry::Mesh;
use crate::memory::pool::Pool;

/// The binary tree and the memory of the passes, kept from build to build.
#[derive(Default)]
pub(crate) struct Optimiser<const N: usize> {
    tree: Tree,
    chunks: Pool<RecordedChunk>,
    reinsertion: Reinsertion,
    choices: Choices,
    memory: Memory<(), N>,
}

impl<const N: usize> Optimiser<N> {
    /// Takes a tree whose memory the next one may use.
    pub fn recycle(&mut self, tree: WideBvh<N>) {
        self.memory.recycle(tree);
    }

    /// Records the binary tree of the splits of `recursion` over `mesh` below `root`; returns whether there is one.
    pub fn record<P: CutPolicy>(
        &mut self,
        recursion: &CutRecursion<'_, P>,
        root: Option<(OwnedCut, Subtrees)>,
        mesh: &Mesh,
        memory: &Memory<CutScratch, N>,
    ) -> bool {
        root.is_some_and(|root| self.tree.record(recursion, root, mesh, memory, &self.chunks))
    }

    /// The optimised wide tree over `mesh`.
    pub fn improve(&mut self, mesh: &Mesh, config: &OptimiseConfig, watch: &mut Stopwatch) -> WideBvh<N> {
        let Self { tree, reinsertion, choices, memory, .. } = self;
        let wanted = (tree.pairs.len() as f32 * config.share) as usize;
        reinsertion.run(tree, config.rounds, wanted);
        watch.lap("reinsertion");
        choices.solve::<_, N>(tree, ROOT, tree.pairs.len(), &config.costs, true);
        let wide = build::build(&CollapsedTree { tree, choices }, Some(ROOT), mesh, memory);
        watch.lap("collapse");
        wide
    }
}
