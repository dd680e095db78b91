//! Parts of the tree that fit a cache, as the cheapest wide tree: they are split down to blocks first, and dynamic
//! programming then chooses nodes and leaves ([`crate::builders::wide::optimal`]).

use crate::builders::binary::kind::Kind;
use crate::builders::binary::node::Node;
use crate::builders::binary::subtrees::Subtrees;
use crate::builders::phr::cut::{Cut, CutLevel};
use crate::builders::phr::memory::CutScratch;
use crate::builders::phr::policy::CutPolicy;
use crate::builders::phr::recursion::CutRecursion;
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::binary_source::Leaves;
use crate::builders::wide::optimal::{Choices, CollapseCosts, CollapseSource};
use crate::builders::wide::top_down::{BinarySplits, TopDown};
use crate::builders::wide::treelet::{WideRoot, WideTreelet};
use crate::bvh::Link;
use crate::geometry::Aabb;
use arrayvec::ArrayVec;

impl<P: CutPolicy, G: Geometry> CutRecursion<'_, P, G> {
    /// Appends the cheapest wide nodes and blocks of a part.
    pub(in crate::builders::phr) fn collapse<const N: usize>(
        &self,
        part: &Cut,
        costs: &CollapseCosts,
        treelet: &mut WideTreelet<N, G::Block>,
        scratch: &mut CutScratch,
    ) -> WideRoot {
        let root = self.split_to_blocks(part, scratch)?;
        let CutScratch { subtrees, choices, .. } = scratch;
        choices.solve::<_, N>(subtrees, root, subtrees.pairs.len(), costs, false);
        let mut leaves = Leaves::of(&self.order.refs, costs.max_leaf);
        // Spatial splits may have separated parts of a triangle that meet again.
        leaves.may_repeat |= self.splits_in_space(part);
        emit(&root, choices, subtrees, &leaves, treelet)
    }

    /// The binary tree over a part; `None` if clipping left nothing of it.
    fn split_to_blocks(&self, part: &Cut, scratch: &mut CutScratch) -> Option<Node> {
        if part.level == CutLevel::SplitDown {
            return Some(scratch.arena[part.range().start]);
        }
        if part.kind != Kind::Inner {
            let mut prims = std::mem::take(&mut scratch.prims);
            prims.clear();
            let bounds = self.leaf(part, &mut prims, scratch);
            let leaf = scratch.subtrees.push_leaf(bounds, &prims);
            scratch.prims = prims;
            return leaf;
        }
        if let Some(subtree) = self.split_down(part, scratch) {
            return subtree;
        }
        let arena = scratch.arena.len();
        let sides = self.split(part, scratch);
        let halves = sides.map(|side| side.and_then(|side| self.split_to_blocks(&side, scratch)));
        scratch.arena.truncate(arena);
        scratch.subtrees.merge(halves)
    }
}

impl CollapseSource for Subtrees {
    type At = Node;

    #[inline(always)]
    fn half_area(&self, node: Node) -> f32 {
        node.bounds().half_area()
    }

    #[inline(always)]
    fn count(&self, node: Node) -> u32 {
        node.count()
    }

    #[inline(always)]
    fn pair(&self, node: Node) -> Option<(usize, [Node; 2])> {
        node.pair().map(|pair| (pair, self.pairs[pair]))
    }
}

/// Appends the nodes and blocks chosen for a subtree.
fn emit<G: Geometry, const N: usize>(
    node: &Node,
    choices: &Choices,
    subtrees: &Subtrees,
    leaves: &Leaves<'_, G>,
    treelet: &mut WideTreelet<N, G::Block>,
) -> WideRoot {
    if node.pair().is_none_or(|pair| choices.of(pair).is_leaf()) {
        return leaves.emit(subtrees, &subtrees.run_of(node), treelet);
    }
    let mut children = ArrayVec::<Node, N>::new();
    choices.open(subtrees, *node, N, &mut children);
    let built: ArrayVec<(Aabb, Link), N> =
        children.iter().filter_map(|child| emit(child, choices, subtrees, leaves, treelet)).collect();
    treelet.node(&built)
}
