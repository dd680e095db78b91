//! The wide nodes of a whole subtree at once: its triangles are gathered first, so that the references below each
//! of its nodes are a run, and nothing is copied from child to child. The tree is that of [`super::widen`].

use crate::builders::binary::kind::Kind;
use crate::builders::binary::node::{Node, NodeRun};
use crate::builders::binary::tree::BinaryTree;
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::binary_source::{BinarySource, Leaves};
use crate::builders::wide::treelet::{WideRoot, WideTreelet};
use crate::bvh::limits::{BLOCK, followed_levels};

/// A subtree of clusters.
pub(crate) struct GatheredTree<'a> {
    /// The tree that it is in.
    pub tree: &'a BinaryTree,
    /// Its triangles in the order of its leaves.
    pub prims: &'a [u32],
}

impl BinarySource for GatheredTree<'_> {
    #[inline(always)]
    fn children(&self, run: &NodeRun) -> [NodeRun; 2] {
        let [left, right] = self.tree.children(&run.node);
        // Clusters lie where they were merged, not in a row.
        self.tree.prefetch(left);
        self.tree.prefetch(right);
        NodeRun::in_a_row([*left, *right], run.first)
    }

    #[inline(always)]
    fn prim(&self, position: usize) -> u32 {
        self.prims[position]
    }
}

impl GatheredTree<'_> {
    /// Appends the wide nodes of the subtree, whose root is `node` at binary depth `depth`; `None`, and nothing
    /// appended, if some of it is too deep to be followed.
    pub fn emit<G: Geometry, const N: usize>(
        &self,
        node: &Node,
        depth: u32,
        leaves: &Leaves<'_, G>,
        treelet: &mut WideTreelet<N, G::Block>,
    ) -> Option<WideRoot> {
        let levels = followed_levels(depth, node.count() as usize);
        let (run, kind) = (NodeRun { node: *node, first: 0 }, Kind::of_count(node.count()));
        debug_assert_eq!(leaves.max_leaf, BLOCK);
        self.emit_or_roll_back((&run, kind), levels, leaves, treelet, &mut 0)
    }
}
