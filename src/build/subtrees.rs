//! Binary subtrees near the leaves, on their way to wide nodes.

use super::binary::Node;
use super::piece::{Piece, Subtree};
use super::top_down::{Kind, QUARTET, WIDTH};
use crate::bvh::{Link, MAX_LEAF_BLOCKS};
use crate::geometry::{Aabb, Mesh};
use arrayvec::ArrayVec;

/// Subtrees of a thread, those made last at the end.
#[derive(Default)]
pub(super) struct Subtrees {
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

    /// The triangles below `node`.
    pub fn prims(&self, node: &Node) -> &[u32] {
        let mut first = node;
        while let Some(pair) = first.pair() {
            first = &self.pairs[pair][0];
        }
        let first = first.run().start;
        &self.prims[first..first + node.count() as usize]
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

    /// What is to become of `node`: a leaf of at most `max_leaf` triangles where that costs no more than a node with
    /// both children as leaves; a leaf costs its blocks, a node one.
    pub fn kind(&self, node: &Node, max_leaf: u32) -> Kind {
        let Some(pair) = node.pair() else { return Kind::Leaf };
        let leaf = |node: &Node| node.bounds().half_area() * node.count().div_ceil(QUARTET) as f32;
        let [left, right] = &self.pairs[pair];
        let is_soft =
            node.count() <= max_leaf && leaf(node) <= node.bounds().half_area() + (leaf(left) + leaf(right));
        if is_soft { Kind::SoftLeaf } else { Kind::Inner }
    }

    /// The children of an inner node.
    pub fn children(&self, node: &Node) -> [Node; 2] {
        self.pairs[node.pair().expect("leaves are not opened")]
    }

    /// Appends to `piece` the wide nodes below `node`, opening the largest first, as
    /// [`super::top_down::TopDown::children`].
    pub fn wide(&self, node: &Node, kind: Kind, leaves: &Leaves<'_>, piece: &mut Piece) -> Subtree {
        if kind != Kind::Inner {
            return leaves.leaf(self.prims(node), piece).map(|link| (node.bounds(), link));
        }
        let mut children: ArrayVec<(Node, Kind, f32), WIDTH> = ArrayVec::new();
        let child = |node: Node| (node, self.kind(&node, leaves.most), node.bounds().half_area());
        children.extend(self.children(node).map(child));
        while children.len() < WIDTH {
            let largest = |kind: Kind| {
                let of_kind = (0..children.len()).filter(|&i| children[i].1 == kind);
                of_kind.reduce(|a, b| if children[b].2 > children[a].2 { b } else { a })
            };
            let Some(next) = largest(Kind::Inner).or_else(|| largest(Kind::SoftLeaf)) else { break };
            let [left, right] = self.children(&children[next].0).map(child);
            children[next] = left;
            children.insert(next + 1, right);
        }
        let built: ArrayVec<(Aabb, Link), WIDTH> =
            children.iter().filter_map(|(child, kind, _)| self.wide(child, *kind, leaves, piece)).collect();
        piece.node(&built)
    }
}

/// How leaves are made.
pub(super) struct Leaves<'a> {
    /// The triangles.
    pub mesh: &'a Mesh,
    /// Most triangles of a leaf that saves a node.
    pub most: u32,
    /// Whether parts of one triangle may meet in a leaf.
    pub may_repeat: bool,
}

impl Leaves<'_> {
    /// Appends the leaf of some triangles.
    pub fn leaf(&self, prims: &[u32], piece: &mut Piece) -> Option<Link> {
        if !self.may_repeat {
            return piece.leaf(self.mesh, prims);
        }
        let mut distinct =
            ArrayVec::<u32, { QUARTET as usize * MAX_LEAF_BLOCKS }>::from_iter(prims.iter().copied());
        distinct.sort_unstable();
        let mut last = None;
        distinct.retain(|prim| last.replace(*prim) != Some(*prim));
        piece.leaf(self.mesh, &distinct)
    }
}
