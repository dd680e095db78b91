//! A part of the wide tree under construction: nodes and leaf blocks whose links are relative to its own arrays.

use super::in_order::{Batch, Place};
use super::top_down::{QUARTET, WIDTH};
use crate::bvh::{Link, MAX_LEAF_BLOCKS, TriangleBlock, WideNode};
use crate::geometry::{Aabb, Mesh};

/// Built by one task.
#[derive(Default)]
pub(super) struct Piece {
    nodes: Vec<WideNode<WIDTH>>,
    blocks: Vec<TriangleBlock>,
}

impl Piece {
    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<WideNode<WIDTH>>()
            + self.blocks.capacity() * size_of::<TriangleBlock>()
    }

    /// Nodes and blocks.
    pub fn lengths(&self) -> Place {
        [self.nodes.len(), self.blocks.len()]
    }

    /// A place for a node before those of its children.
    pub fn reserve_node(&mut self) -> usize {
        self.nodes.push(WideNode::EMPTY);
        self.nodes.len() - 1
    }

    /// Fills the node in place `index` with those of its children of which clipping left something.
    pub fn finish_node(&mut self, index: usize, children: &[(Aabb, Link)]) -> Option<(Aabb, Link)> {
        if let [] | [_] = children {
            // A node left in place for a lone inner child would only cost a visit, and taking it out would move
            // the ones after it: it is rare, so it stays.
            if children.first().is_none_or(|(_, link)| !link.is_inner()) {
                self.nodes.pop();
                return children.first().copied();
            }
        }
        self.nodes[index] = WideNode::of(children);
        let bounds = children.iter().map(|(bounds, _)| *bounds).collect();
        Some((bounds, Link::inner(index)))
    }

    /// Appends the blocks of a leaf; `None` without triangles.
    pub fn leaf(&mut self, mesh: &Mesh, prims: &[u32]) -> Option<Link> {
        if prims.is_empty() {
            return None;
        }
        let first = self.blocks.len();
        debug_assert!(prims.len() <= QUARTET as usize * MAX_LEAF_BLOCKS);
        self.blocks.extend(prims.chunks(QUARTET as usize).map(|prims| TriangleBlock::of(mesh, prims)));
        Some(Link::leaf(first, self.blocks.len() - first))
    }
}

impl Batch for Piece {
    type A = WideNode<WIDTH>;
    type B = TriangleBlock;

    fn elements(&self) -> (&[Self::A], &[Self::B]) {
        (&self.nodes, &self.blocks)
    }

    #[inline]
    fn moved(node: &Self::A, [nodes, blocks]: Place) -> Self::A {
        let mut node = *node;
        node.links = node.links.map(|link| link.moved(nodes, blocks));
        node
    }

    fn clear(&mut self) {
        self.nodes.clear();
        self.blocks.clear();
    }
}
