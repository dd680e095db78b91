//! The nodes and leaf blocks that one task makes of the wide tree: links are relative to its own arrays.

use crate::builders::prims::geometry::Geometry;
use crate::bvh::limits::{BLOCK, MAX_LEAF};
use crate::bvh::{Link, TriangleBlock, WideNode};
use crate::geometry::Aabb;
use crate::memory::huge_pages;
use crate::memory::stream::{self, Vectors};
use crate::parallel::ordered_append::{Chunk, Offset};
use std::mem::MaybeUninit;

/// The root of a subtree of the wide tree: its box and link, or nothing if clipping left nothing of it.
pub(crate) type WideRoot = Option<(Aabb, Link)>;

/// The roots of treelets as they lie in the tree.
pub(crate) fn moved(built: Vec<(WideRoot, Offset)>) -> Vec<WideRoot> {
    let moved = |(root, [nodes, blocks]): (WideRoot, Offset)| {
        root.map(|(bounds, link)| (bounds, link.moved(nodes, blocks)))
    };
    built.into_iter().map(moved).collect()
}

/// Appends a node over finished subtrees: nodes come after those below them. A lone subtree takes its place.
pub(crate) fn append_node<const N: usize>(
    children: &[(Aabb, Link)],
    nodes: &mut Vec<WideNode<N>>,
) -> WideRoot {
    match children {
        [] => None,
        [only] => Some(*only),
        _ => {
            let bounds = children.iter().map(|(bounds, _)| *bounds).collect();
            huge_pages::push(nodes, WideNode::of(children), "nodes");
            Some((bounds, Link::of_node(nodes.len() - 1)))
        }
    }
}

/// Nodes of `N` children and leaf blocks of one task.
pub(crate) struct WideTreelet<const N: usize, B = TriangleBlock> {
    /// Children before parents.
    pub nodes: Vec<WideNode<N>>,
    /// Those of a leaf in a row.
    pub blocks: Vec<B>,
}

impl<const N: usize, B> Default for WideTreelet<N, B> {
    fn default() -> Self {
        Self { nodes: Vec::new(), blocks: Vec::new() }
    }
}

impl<const N: usize, B> WideTreelet<N, B> {
    /// Removes what was appended since the lengths were as given.
    pub fn rollback(&mut self, [nodes, blocks]: Offset) {
        self.nodes.truncate(nodes);
        self.blocks.truncate(blocks);
    }

    /// Appends a node over finished subtrees.
    pub fn node(&mut self, children: &[(Aabb, Link)]) -> WideRoot {
        append_node(children, &mut self.nodes)
    }

    /// Appends the block of a leaf of the first `count` primitives, one to four, of `prims`.
    // Not inlined, so that it is made in place: callers of much else copy it.
    #[inline(never)]
    pub fn block<G: Geometry<Block = B>>(&mut self, geometry: &G, count: usize, prims: [u32; 4]) -> Link {
        self.blocks.push(geometry.block(count, prims));
        Link::of_blocks(self.blocks.len() - 1, 1)
    }

    /// Appends the blocks of a leaf; `None` without primitives.
    pub fn leaf<G: Geometry<Block = B>>(&mut self, geometry: &G, prims: &[u32]) -> Option<Link> {
        if prims.is_empty() {
            return None;
        }
        let first = self.blocks.len();
        assert!(prims.len() <= MAX_LEAF as usize, "a leaf of {} primitives", prims.len());
        self.blocks.extend(prims.chunks(BLOCK as usize).map(|prims| geometry.block_of(prims)));
        Some(Link::of_blocks(first, self.blocks.len() - first))
    }
}

impl<const N: usize, B: Vectors + Copy + Send> Chunk for WideTreelet<N, B> {
    type A = WideNode<N>;
    type B = B;

    fn elements(&self) -> (&[Self::A], &[Self::B]) {
        (&self.nodes, &self.blocks)
    }

    #[inline]
    fn moved(node: &Self::A, [nodes, blocks]: Offset) -> Self::A {
        let mut node = *node;
        for link in &mut node.links {
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
