//! A part of the wide tree under construction: nodes and leaf blocks whose links are relative to its own arrays.

#![allow(unsafe_code)]

use crate::builders::wide::top_down::{QUARTET, WIDTH};
use crate::bvh::{Link, MAX_LEAF_BLOCKS, TriangleBlock, WideNode};
use crate::geometry::{Aabb, Mesh};
use crate::memory::stream::{self, Vectors};
use crate::parallel::ordered_append::{self, Batch, Place, Spare};
use glam::Vec4;
use std::mem::MaybeUninit;
use std::sync::OnceLock;

/// A subtree: its box and link, or nothing if clipping left nothing of it.
pub(crate) type Subtree = Option<(Aabb, Link)>;

/// Builds `tasks` pieces by `make` and appends them in order to `nodes` and `blocks`; returns their subtrees, as
/// they lie there.
pub(crate) fn append(
    tasks: usize,
    spare: &Spare<Piece>,
    nodes: &mut Vec<WideNode<WIDTH>>,
    blocks: &mut Vec<TriangleBlock>,
    make: impl Fn(usize, &mut Piece) -> Subtree + Sync,
) -> Vec<Subtree> {
    let built: Vec<OnceLock<(Subtree, Place)>> = (0..tasks).map(|_| OnceLock::new()).collect();
    let mut at = [nodes.len(), blocks.len()];
    ordered_append::append(tasks, spare, nodes, blocks, |i, piece: &mut Piece| {
        let subtree = make(i, piece);
        built[i].set((subtree, [piece.nodes.len(), piece.blocks.len()])).expect("each task runs once");
    });
    built
        .into_iter()
        .map(|built| {
            let (subtree, len) = built.into_inner().expect("all tasks have run");
            let moved = subtree.map(|(bounds, link)| (bounds, link.moved(at[0], at[1])));
            at = [at[0] + len[0], at[1] + len[1]];
            moved
        })
        .collect()
}

/// Appends a node over finished subtrees: nodes come after those below them. Of a lone subtree none is made.
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

/// Built by one task.
#[derive(Default)]
pub(crate) struct Piece {
    /// Children before parents.
    pub nodes: Vec<WideNode<WIDTH>>,
    /// Those of a leaf in a row.
    pub blocks: Vec<TriangleBlock>,
}

impl Piece {
    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<WideNode<WIDTH>>()
            + self.blocks.capacity() * size_of::<TriangleBlock>()
    }

    /// How many nodes and blocks there are.
    pub fn mark(&self) -> [usize; 2] {
        [self.nodes.len(), self.blocks.len()]
    }

    /// Forgets what was appended since `mark`.
    pub fn release(&mut self, [nodes, blocks]: [usize; 2]) {
        self.nodes.truncate(nodes);
        self.blocks.truncate(blocks);
    }

    /// Appends a node over finished subtrees.
    pub fn node(&mut self, children: &[(Aabb, Link)]) -> Subtree {
        append_node(children, &mut self.nodes)
    }

    /// Appends the block of a leaf of the first `count` triangles, one to four, of `prims`.
    #[inline]
    pub fn quartet(&mut self, mesh: &Mesh, count: usize, prims: [u32; 4]) -> Link {
        self.blocks.push(TriangleBlock::of_first(count, prims, mesh));
        Link::leaf(self.blocks.len() - 1, 1)
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
        let [a, b, c, d] = &mut node.links;
        for link in [a, b, c, d] {
            *link = link.moved(nodes, blocks);
        }
        node
    }

    fn put(&self, at: Place, nodes: &mut [MaybeUninit<Self::A>], blocks: &mut [MaybeUninit<Self::B>]) {
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
