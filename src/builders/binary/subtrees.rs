//! Binary subtrees near the leaves, on their way to wide nodes.

use crate::builders::binary::Node;
use crate::builders::wide::largest_first::{self, At, KnownSplits};
use crate::builders::wide::top_down::Kind;

/// Subtrees of a thread, those made last at the end.
#[derive(Default)]
pub(crate) struct Subtrees {
    /// Pairs of siblings. Leaves are runs of `prims`, and so is every subtree.
    pub pairs: Vec<[Node; 2]>,
    /// Triangles.
    pub prims: Vec<u32>,
}

impl Subtrees {
    /// How many pairs and triangles there are.
    pub fn mark(&self) -> [usize; 2] {
        [self.pairs.len(), self.prims.len()]
    }

    /// Forgets what was made since `mark`.
    pub fn release(&mut self, [pairs, prims]: [usize; 2]) {
        self.pairs.truncate(pairs);
        self.prims.truncate(prims);
    }

    /// `node` with the place of its first triangle.
    pub fn at(&self, node: &Node) -> At {
        let mut first = node;
        while let Some(pair) = first.pair() {
            first = &self.pairs[pair][0];
        }
        At { node: *node, first: first.run().start as u32 }
    }

    /// The triangles below `node`.
    pub fn run(&self, node: &Node) -> &[u32] {
        let first = self.at(node).first as usize;
        &self.prims[first..first + node.count() as usize]
    }

    /// The children of an inner node.
    pub fn children(&self, node: &Node) -> [Node; 2] {
        self.pairs[node.pair().expect("leaves are not opened")]
    }

    /// What is to become of `node`.
    pub fn kind(&self, node: &Node, max_leaf: u32) -> Kind {
        largest_first::kind(node, max_leaf, || self.children(node))
    }

    /// Appends a copy of the subtree of `node` in `from`.
    pub fn graft(&mut self, node: &Node, from: &Self) -> Node {
        match node.pair() {
            None => {
                let first = self.prims.len();
                self.prims.extend(&from.prims[node.run()]);
                Node::leaf(node.bounds(), first, node.count())
            }
            Some(pair) => {
                let children = from.pairs[pair].map(|child| self.graft(&child, from));
                self.pairs.push(children);
                Node::inner(&children, self.pairs.len() - 1)
            }
        }
    }
}

impl KnownSplits for Subtrees {
    #[inline(always)]
    fn children(&self, at: &At) -> [At; 2] {
        let [left, right] = self.children(&at.node);
        [At { node: left, first: at.first }, At { node: right, first: at.first + left.count() }]
    }

    #[inline(always)]
    fn prim(&self, place: usize) -> u32 {
        self.prims[place]
    }
}
