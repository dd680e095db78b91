//! Small cuts: `subtree_sweep` splits them down to leaves in one go.

use crate::builders::binary::node::Node;
use crate::builders::phr::cut::Cut;
use crate::builders::phr::memory::CutScratch;
use crate::builders::phr::policy::CutPolicy;
use crate::builders::phr::recursion::CutRecursion;
use crate::builders::prims::geometry::Geometry;
use crate::bvh::limits::BLOCK;

impl<P: CutPolicy, G: Geometry> CutRecursion<'_, P, G> {
    /// Whether a cut that is not split spatially is split down to its leaves in one go.
    #[inline]
    pub(in crate::builders::phr) fn is_small(&self, cut: &Cut) -> bool {
        cut.count <= self.config.extensions.subtree_sweep.unwrap_or(0) && cut.depth < self.cut_depth
    }

    /// Whether any cut of more than a block is.
    #[inline]
    pub(in crate::builders::phr) fn splits_down_small_cuts(&self) -> bool {
        self.config.extensions.subtree_sweep.is_some_and(|most| most > BLOCK)
    }

    /// Splits a small cut down to its leaves; `None` if clipping left nothing of it.
    pub(in crate::builders::phr) fn split_down_small_cut(
        &self,
        cut: &Cut,
        scratch: &mut CutScratch,
    ) -> Option<Node> {
        let CutScratch { arena, subtree_sweep, subtrees, .. } = scratch;
        subtree_sweep.clear();
        for node in &arena[cut.range()] {
            self.order.open_all(self.tree, node, &cut.clip, &mut |reference| {
                subtree_sweep.push(reference.bounds(), self.order.prim(reference.run().start));
            });
        }
        subtree_sweep.build(self.isa, subtrees)
    }
}
