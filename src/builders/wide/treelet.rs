//! The nodes and leaf blocks that one task makes of the wide tree: links are relative to its own arrays.

#![allow(unsafe_code)]

use crate::bvh::limits::{BLOCK, MAX_LEAF, WIDTH};
use crate::bvh::{Link, TriangleBlock, WideNode};
use crate::geometry::{Aabb, Mesh};
use crate::memory::stream::{self, Vectors};
use crate::parallel::ordered_append::{Chunk, Offset};
use glam::Vec4;
use std::mem::MaybeUninit;

/// A subtree: its box and link, or nothing if clipping left nothing of it.
pub(crate) type Subtree = Option<(Aabb, Link)>;

/// The subtrees of treelets as they lie in the tree.
pub(crate) fn moved(built: Vec<(Subtree, Offset)>) -> Vec<Subtree> {
    let moved = |(subtree, [nodes, blocks]): (Subtree, Offset)| {
        subtree.map(|(bounds, link)| (bounds, link.moved(nodes, blocks)))
    };
    built.into_iter().map(moved).collect()
}

/// Appends a node over finished subtrees: nodes come after those below them. A lone subtree takes its place.
pub(crate) fn append_node(children: &[(Aabb, Link)], nodes: &mut Vec<WideNode<WIDTH>>) -> Subtree {
    match children {
        [] => None,
        [only] => Some(*only),
        _ => {
            let bounds = children.iter().map(|(bounds, _)| *bounds).collect();
            nodes.push(WideNode::of(children));
            Some((bounds, Link::inner(nodes.len() - 1)))
        }
    }
}

/// Nodes and leaf blocks of one task.
#[derive(Default)]
pub(crate) struct WideTreelet {
    /// Children before parents.
    pub nodes: Vec<WideNode<WIDTH>>,
    /// Those of a leaf in a row.
    pub blocks: Vec<TriangleBlock>,
}

impl WideTreelet {
    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<WideNode<WIDTH>>()
            + self.blocks.capacity() * size_of::<TriangleBlock>()
    }

    /// Removes what was appended since the lengths were as given.
    pub fn rollback(&mut self, [nodes, blocks]: Offset) {
        self.nodes.truncate(nodes);
        self.blocks.truncate(blocks);
    }

    /// Appends a node over finished subtrees.
    pub fn node(&mut self, children: &[(Aabb, Link)]) -> Subtree {
        append_node(children, &mut self.nodes)
    }

    /// Appends the block of a leaf of the first `count` triangles, one to four, of `prims`.
    #[inline]
    pub fn block(&mut self, mesh: &Mesh, count: usize, prims: [u32; 4]) -> Link {
        self.blocks.push(TriangleBlock::of_first(count, prims, mesh));
        Link::leaf(self.blocks.len() - 1, 1)
    }

    /// Appends the blocks of a leaf; `None` without triangles.
    pub fn leaf(&mut self, mesh: &Mesh, prims: &[u32]) -> Option<Link> {
        if prims.is_empty() {
            return None;
        }
        let first = self.blocks.len();
        assert!(prims.len() <= MAX_LEAF as usize, "a leaf of {} triangles", prims.len());
        self.blocks.extend(prims.chunks(BLOCK as usize).map(|prims| TriangleBlock::of(mesh, prims)));
        Some(Link::leaf(first, self.blocks.len() - first))
    }
}

impl Chunk for WideTreelet {
    type A = WideNode<WIDTH>;
    type B = TriangleBlock;

    fn elements(&self) -> (&[Self::A], &[Self::B]) {
        (&self.nodes, &self.blocks)
    }

    #[inline]
    fn moved(node: &Self::A, [nodes, blocks]: Offset) -> Self::A {
        let mut node = *node;
        let [a, b, c, d] = &mut node.links;
        for link in [a, b, c, d] {
            *link = link.moved(nodes, blocks);
        }
        node
    }

    fn write(&self, at: Offset, nodes: &mut [MaybeUninit<Self::A>], blocks: &mut [MaybeUninit<Self::B>]) {
        // Nobody reads the tree before it is whole.
        for (to, node) in nodes.iter_mut().zip(&self.nodes) {
            stream::write(to, &Self::moved(node, at));
        }
        for (to, block) in blocks.iter_mut().zip(&self.blocks) {
            stream::write(to, block);
        }
        stream::fence();
    }

    fn clear(&mut self) {
        self.nodes.clear();
        self.blocks.clear();
    }
}

// SAFETY: a node is three lower planes, three upper ones, four links and padding, in this order; any bits are floats
// and links.
unsafe impl Vectors<8> for WideNode<WIDTH> {
    #[inline(always)]
    fn vectors(&self) -> [Vec4; 8] {
        let ([a, b, c], [d, e, f]) = (self.lower, self.upper);
        let link = |slot: usize| f32::from_bits(self.links[slot].bits());
        let links = [link(0), link(1), link(2), link(3)];
        [a.into(), b.into(), c.into(), d.into(), e.into(), f.into(), links.into(), Vec4::ZERO]
    }
}

// SAFETY: a block is three rows of corners, three of either edge and four numbers, in this order; any bits are floats
// and numbers.
unsafe impl Vectors<10> for TriangleBlock {
    #[inline(always)]
    fn vectors(&self) -> [Vec4; 10] {
        let ([a, b, c], [d, e, f], [g, h, i]) = (self.v0, self.e1, self.e2);
        let prim = |lane: usize| f32::from_bits(self.prims[lane]);
        let prims = [prim(0), prim(1), prim(2), prim(3)];
        [
            a.into(),
            b.into(),
            c.into(),
            d.into(),
            e.into(),
            f.into(),
            g.into(),
            h.into(),
            i.into(),
            prims.into(),
        ]
    }
}
