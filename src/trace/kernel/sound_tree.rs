//! The proof that a tree's links may be followed unchecked: trees have public fields, the kernel reads them
//! without bounds checks and with a stack of fixed size.

#![allow(unsafe_code)]

use crate::builders::RefitError;
use crate::bvh::limits::{MAX_BLOCKS, check_width};
use crate::bvh::saved::{SavedError, SavedTree};
use crate::bvh::{Child, Link, MAX_DEPTH, MAX_LEAF_BLOCKS, TriangleBlock, WideBvh, WideNode};
use crate::geometry::Mesh;
use crate::memory::{OutOfMemory, catch_out_of_memory, huge_pages};
use std::hint::select_unpredictable;
use std::path::Path;

/// A tree whose links are in range, whose nodes have one parent each and whose inner levels do not exceed
/// [`MAX_DEPTH`], over leaf blocks of some form. Only made by [`SoundTree::new`], or of a [`ProvenTree`], which that or
/// [`WideBvh::load`] has found so; the borrow keeps the proof true.
#[derive(Debug)]
pub(super) struct SoundTree<'a, const N: usize, B = TriangleBlock> {
    /// The tree's root, or a link reached from it.
    root: Link,
    nodes: &'a [WideNode<N>],
    blocks: &'a [B],
}

impl<const N: usize, B> Clone for SoundTree<'_, N, B> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<const N: usize, B> Copy for SoundTree<'_, N, B> {}

impl<'a, const N: usize, B> SoundTree<'a, N, B> {
    /// Walks `tree` from the root. Unwinds to [`catch_out_of_memory`] where there is no memory for that.
    pub(super) fn new(tree: &'a WideBvh<N, B>) -> Result<Self, String> {
        const { check_width::<N>() };
        let mut seen = huge_pages::filled(tree.nodes.len(), false, "the proof of a tree");
        let mut pending = vec![(tree.root, 0)];
        while let Some((link, level)) = pending.pop() {
            match link.get() {
                Child::Empty => {}
                Child::Leaf { first, count } => {
                    if count > MAX_LEAF_BLOCKS || first + count > tree.blocks.len() {
                        return Err(format!("leaf of {count} blocks from {first} of {}", tree.blocks.len()));
                    }
                }
                Child::Inner(index) => {
                    let Some(node) = tree.nodes.get(index) else {
                        return Err(format!("link to node {index} of {}", tree.nodes.len()));
                    };
                    if std::mem::replace(&mut seen[index], true) {
                        return Err(format!("node {index} has two parents"));
                    }
                    if level == MAX_DEPTH {
                        return Err(format!("more than {MAX_DEPTH} inner levels"));
                    }
                    pending.extend(node.links.iter().map(|&child| (child, level + 1)));
                }
            }
        }
        Ok(Self { root: tree.root, nodes: &tree.nodes, blocks: &tree.blocks })
    }

    /// The same tree over `blocks`, one for each of its own.
    pub(super) fn over<C>(self, blocks: &'a [C]) -> SoundTree<'a, N, C> {
        assert_eq!(blocks.len(), self.blocks.len(), "a block for each of the tree's");
        SoundTree { root: self.root, nodes: self.nodes, blocks }
    }
}

impl<'a, const N: usize, B> SoundTree<'a, N, B> {
    /// Where traversal starts.
    #[inline(always)]
    pub(super) fn root(self) -> Link {
        self.root
    }

    /// The part of the tree below `link`.
    ///
    /// # Safety
    /// `link` was reached from the root.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) unsafe fn below(self, link: Link) -> Self {
        Self { root: link, ..self }
    }

    /// Node `index`.
    ///
    /// # Safety
    /// `index` comes from an inner link reached from the root.
    #[inline(always)]
    pub(super) unsafe fn node(self, index: usize) -> &'a WideNode<N> {
        debug_assert!(index < self.nodes.len());
        // SAFETY: whoever proved the tree found every inner link reached from the root in range.
        unsafe { self.nodes.get_unchecked(index) }
    }

    /// The blocks of a leaf.
    ///
    /// # Safety
    /// `first` and `count` come from a leaf's link reached from the root.
    #[inline(always)]
    pub(super) unsafe fn leaf(self, first: usize, count: usize) -> &'a [B] {
        debug_assert!(first + count <= self.blocks.len());
        // SAFETY: whoever proved the tree found every leaf reached from the root in range.
        unsafe { self.blocks.get_unchecked(first..first + count) }
    }

    /// Address of the data of `link`, for prefetching only.
    #[inline(always)]
    pub(super) fn address(self, link: Link) -> *const u8 {
        const INDEX: u32 = MAX_BLOCKS as u32 - 1;
        // Without a branch: which of them a link is, is hard to foresee.
        let is_inner = link.is_inner();
        let start =
            select_unpredictable(is_inner, self.nodes.as_ptr().cast(), self.blocks.as_ptr().cast::<u8>());
        let size = select_unpredictable(is_inner, size_of::<WideNode<N>>(), size_of::<B>());
        start.wrapping_add((link.bits() & INDEX) as usize * size)
    }
}

/// A sound tree that owns its nodes: proven once, traced often.
#[derive(Debug)]
pub struct ProvenTree<const N: usize, B = TriangleBlock>(WideBvh<N, B>);

impl<const N: usize, B> Default for ProvenTree<N, B> {
    /// A tree of nothing.
    fn default() -> Self {
        Self(WideBvh::default())
    }
}

impl<const N: usize, B> ProvenTree<N, B> {
    /// Walks `tree` once, to prove that kernels may follow its links unchecked.
    ///
    /// # Errors
    /// The flaw of a malformed tree: links out of range, shared or cyclic nodes, more than [`MAX_DEPTH`] inner levels.
    /// Or no memory to walk it.
    pub fn new(tree: WideBvh<N, B>) -> Result<Self, String> {
        Self::proven(tree).unwrap_or_else(|error| Err(error.to_string()))
    }

    /// The same, which tells a flaw from a lack of memory.
    pub(crate) fn proven(tree: WideBvh<N, B>) -> Result<Result<Self, String>, OutOfMemory> {
        let flaw = catch_out_of_memory(|| SoundTree::new(&tree).err())?;
        Ok(flaw.map_or(Ok(Self(tree)), Err))
    }

    /// The tree, given back.
    pub fn into_inner(self) -> WideBvh<N, B> {
        self.0
    }

    /// The tree.
    pub fn get(&self) -> &WideBvh<N, B> {
        &self.0
    }

    #[inline(always)]
    pub(super) fn sound(&self) -> SoundTree<'_, N, B> {
        SoundTree { root: self.0.root, nodes: &self.0.nodes, blocks: &self.0.blocks }
    }
}

impl<const N: usize> ProvenTree<N> {
    /// Fits the tree to a mesh that has moved. It stays proven, after an error too: boxes and corners are written anew,
    /// links stay what they are.
    ///
    /// # Errors
    /// As of [`WideBvh::refit`]; the tree is as before then.
    pub fn refit(&mut self, mesh: &Mesh) -> Result<(), RefitError> {
        self.0.refit(mesh)
    }

    /// The tree saved at `path` for `mesh`: what [`WideBvh::load`] finds of its links is all that kernels need.
    ///
    /// # Errors
    /// As of [`WideBvh::load`].
    pub fn load(mesh: &Mesh, path: &Path) -> Result<Self, SavedError> {
        WideBvh::load(mesh, path).map(Self)
    }

    /// The tree of an open file, likewise.
    pub(crate) fn read(mesh: &Mesh, saved: SavedTree<'_>) -> Result<Self, SavedError> {
        WideBvh::read(mesh, saved).map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use glam::Vec3A;

    fn tree(links: &[(usize, Link)], nodes: usize) -> WideBvh<4> {
        let mut tree = WideBvh::<4> { root: Link::inner(0), ..WideBvh::default() };
        tree.nodes = vec![WideNode::EMPTY; nodes];
        tree.blocks = vec![TriangleBlock::EMPTY; 2];
        for (slot, &(node, link)) in links.iter().enumerate() {
            tree.nodes[node].set(slot % 4, Aabb::new(Vec3A::ZERO, Vec3A::ONE), link);
        }
        tree
    }

    #[test]
    fn malformed_trees_are_refused() {
        assert!(SoundTree::new(&WideBvh::<4>::default()).is_ok());
        assert!(SoundTree::new(&tree(&[(0, Link::leaf(0, 2))], 1)).is_ok());
        let flaw = |tree: &WideBvh<4>| SoundTree::new(tree).unwrap_err();
        assert!(flaw(&tree(&[(0, Link::leaf(1, 2))], 1)).contains("leaf of 2 blocks from 1"));
        // Nobody makes such a link, but a file may hold one.
        let long =
            Link::from_bits(Link::leaf(0, 7).bits() + (Link::leaf(0, 2).bits() - Link::leaf(0, 1).bits()));
        assert!(flaw(&tree(&[(0, long)], 1)).contains("leaf of 8 blocks"));
        assert!(flaw(&tree(&[(0, Link::inner(7))], 1)).contains("node 7 of 1"));
        assert!(flaw(&tree(&[(0, Link::inner(0))], 1)).contains("two parents"));
        assert!(flaw(&tree(&[(0, Link::inner(1)), (0, Link::inner(1))], 2)).contains("two parents"));
        let chain: Vec<_> = (0..MAX_DEPTH).map(|node| (node, Link::inner(node + 1))).collect();
        assert!(flaw(&tree(&chain, MAX_DEPTH + 1)).contains("inner levels"));
        assert!(SoundTree::new(&tree(&chain[..MAX_DEPTH - 1], MAX_DEPTH)).is_ok());
    }
}
