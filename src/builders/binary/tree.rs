//! Binary trees over runs of references in Morton order: the auxiliary BVH.

use super::node::Node;
use crate::memory::prefetch;

/// Subtrees of at most so many references are built by one task: their pairs lie in a row, children before parents.
pub(crate) const TREELET: usize = 1 << 12;

/// Subtrees so many levels below the root are built by one task, too, however large.
pub(crate) const MOST_DIVIDED_LEVELS: u32 = 64;

/// A binary tree whose leaves are runs of references.
#[derive(Default)]
pub(crate) struct BinaryTree {
    /// `None` without triangles.
    pub root: Option<Node>,
    /// Pairs of siblings.
    pub pairs: Vec<[Node; 2]>,
}

impl BinaryTree {
    /// The children of an inner node.
    #[inline]
    pub fn children(&self, node: &Node) -> &[Node; 2] {
        &self.pairs[node.pair_of_inner()]
    }

    /// The positions of the references below a node of an LBVH, where they are a run.
    #[inline]
    pub fn run(&self, node: &Node) -> std::ops::Range<usize> {
        let mut first = *node;
        while !first.is_leaf() {
            first = self.children(&first)[0];
        }
        let start = first.run().start;
        start..start + node.count() as usize
    }

    /// Prefetches the children of a node that is likely to be opened soon.
    #[inline]
    pub fn prefetch(&self, node: &Node) {
        if let Some(pair) = node.pair() {
            prefetch::line(&self.pairs, pair);
        }
    }
}
