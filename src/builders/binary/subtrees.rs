//! Binary subtrees near the leaves, in the memory of one thread.

use super::node::{Node, NodeRun};
use crate::geometry::Aabb;

/// Subtrees of a thread, the latest at the end.
#[derive(Default)]
pub(crate) struct Subtrees {
    /// Pairs of siblings. Leaves are runs of `prims`, and so is every subtree.
    pub pairs: Vec<[Node; 2]>,
    /// Triangles.
    pub prims: Vec<u32>,
}

impl Subtrees {
    /// Numbers of pairs and triangles.
    pub fn checkpoint(&self) -> [usize; 2] {
        [self.pairs.len(), self.prims.len()]
    }

    /// Removes what was appended since `checkpoint`.
    pub fn rollback(&mut self, [pairs, prims]: [usize; 2]) {
        self.pairs.truncate(pairs);
        self.prims.truncate(prims);
    }

    /// `node` with the position of its first triangle.
    pub fn run_of(&self, node: &Node) -> NodeRun {
        let mut first = node;
        while let Some(pair) = first.pair() {
            first = &self.pairs[pair][0];
        }
        NodeRun { node: *node, first: first.run().start as u32 }
    }

    /// The triangles below `node`.
    pub fn prims_below(&self, node: &Node) -> &[u32] {
        let first = self.run_of(node).first as usize;
        &self.prims[first..first + node.count() as usize]
    }

    /// The children of an inner node.
    #[inline(always)]
    pub fn children(&self, node: &Node) -> [Node; 2] {
        self.pairs[node.pair_of_inner()]
    }

    /// Appends the leaf of `prims`; `None` without triangles.
    pub fn push_leaf(&mut self, bounds: Aabb, prims: &[u32]) -> Option<Node> {
        let first = self.prims.len();
        self.prims.extend_from_slice(prims);
        (!prims.is_empty()).then(|| Node::leaf(bounds, first, prims.len() as u32))
    }

    /// Appends the parent of two subtrees; a lone one takes its place.
    pub fn merge(&mut self, halves: [Option<Node>; 2]) -> Option<Node> {
        Node::join_any(halves, &mut self.pairs)
    }

    /// Appends a copy of the subtree of `node` in `from`.
    pub fn copy(&mut self, node: &Node, from: &Self) -> Node {
        let copied = match node.pair() {
            None => self.push_leaf(node.bounds(), &from.prims[node.run()]),
            Some(pair) => {
                let children = from.pairs[pair].map(|child| Some(self.copy(&child, from)));
                self.merge(children)
            }
        };
        copied.expect("a subtree holds a triangle")
    }
}
