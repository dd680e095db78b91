//! A cut of leaves alone has nothing to refine: it is split down to its leaves by sweeps in one go, to the same tree.

use crate::builders::binary::node::Node;
use crate::builders::phr::clip::is_inside;
use crate::builders::phr::cut::{Cut, CutLevel};
use crate::builders::phr::memory::CutScratch;
use crate::builders::phr::policy::CutPolicy;
use crate::builders::phr::recursion::CutRecursion;
use crate::builders::prims::geometry::Geometry;
use crate::bvh::limits::SUBTREE_MOST;

/// Fewest leaves of a cut that is split in one go: shorter ones are split faster one by one.
const FEWEST: usize = 9;

impl<P: CutPolicy, G: Geometry> CutRecursion<'_, P, G> {
    /// Whether a cut is of leaves alone, and no extension applies near the leaves.
    pub(in crate::builders::phr) fn is_of_leaves(&self, cut: &Cut) -> bool {
        // Excluded: clipped cuts, and under `collapse` pieces of presplit triangles: a leaf counts those of a triangle
        // once.
        let may_repeat = !self.order.refs.fragments.is_empty();
        let is_treated_otherwise = P::SEES
            || self.has_finished_leaves
            || may_repeat && self.config.extensions.collapse.is_some()
            || self.splits_down_small_cuts();
        cut.count == cut.len
            && !is_treated_otherwise
            && cut.level == CutLevel::Subtrees
            && (FEWEST..=SUBTREE_MOST).contains(&(cut.len as usize))
            && cut.depth < self.cut_depth
            && is_inside(cut.bounds, &cut.clip)
    }

    /// Splits such a cut down to its leaves.
    pub(in crate::builders::phr) fn split_down_leaf_cut(&self, cut: &Cut, scratch: &mut CutScratch) -> Node {
        let CutScratch { arena, subtree_sweep, subtrees, counts, .. } = scratch;
        subtree_sweep.clear();
        for node in &arena[cut.range()] {
            subtree_sweep.push(node.bounds(), self.order.prim(node.run().start));
        }
        let pairs = subtrees.pairs.len();
        let root = subtree_sweep.build_as_cut(self.isa, self.cut_depth - cut.depth, subtrees);
        let made = &subtrees.pairs[pairs..];
        counts.splits += made.len() as u64;
        counts.swept += made.iter().flatten().map(|node| u64::from(node.count())).sum::<u64>();
        root
    }
}
