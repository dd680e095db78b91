//! The references of a build in Morton order, and the leaves of the auxiliary BVH opened to them.

use super::clip::{Clipper, is_whole, open};
use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::lbvh::key::{MortonKey, code, reference};
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::bvh::Link;
use crate::geometry::{Aabb, Mesh};

/// The references in Morton order, to which the leaves of the auxiliary BVH are opened.
pub(crate) struct RefOrder<'a, G = Mesh> {
    /// Sorted keys.
    pub keys: &'a [MortonKey],
    /// What they refer to.
    pub refs: PrimRefs<'a, G>,
}

impl<G: Geometry> RefOrder<'_, G> {
    /// Gives `take` the references below `node`, a node of a cut clipped to `clip`: leaves of one
    /// reference, their boxes clipped. Finished leaves are not opened.
    pub fn open_all(&self, tree: &BinaryTree, node: &Node, clip: &Aabb, take: &mut impl FnMut(Node)) {
        if !node.is_leaf() {
            open(tree, node, clip, |child| self.open_all(tree, &child, clip, take));
            return;
        }
        if node.count() == 1 || node.is_finished() {
            take(*node);
            return;
        }
        let bounds = |position: usize| self.refs.bounds(reference(self.keys[position]));
        if is_whole(node, clip) {
            node.run().for_each(|position| take(Node::leaf(bounds(position), position, 1)));
            return;
        }
        let clipper = Clipper { clip, parent: node.run().map(bounds).collect() };
        for position in node.run() {
            if let Some(bounds) = clipper.clip(bounds(position)) {
                take(Node::leaf(bounds, position, 1));
            }
        }
    }

    /// The link of a finished leaf, which has its place.
    #[inline]
    pub fn link(&self, leaf: &Node) -> Link {
        Link::from_bits(code(self.keys[leaf.run().start])).placed()
    }

    /// The primitive at a position.
    #[inline]
    pub fn prim(&self, position: usize) -> u32 {
        self.refs.prim(reference(self.keys[position]))
    }
}
