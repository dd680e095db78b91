//! Binary trees over runs of references in Morton order: the auxiliary BVH.

#![allow(unsafe_code)]

use crate::geometry::Aabb;
use glam::{Vec3A, Vec4};

/// A subtree: its box, how many references it holds, and where they are. Two of them fill a cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Node {
    min: [f32; 3],
    /// A leaf: [`Node::LEAF`] and the position of its first reference in the order. Else the index of the pair
    /// of children in [`BinaryTree::pairs`].
    link: u32,
    max: [f32; 3],
    /// References below, >= 1.
    pub count: u32,
}

impl Node {
    const LEAF: u32 = 1 << 31;

    /// A node without meaning, to size arrays with.
    pub const ZERO: Self = Self { min: [0.0; 3], link: 0, max: [0.0; 3], count: 0 };

    /// The leaf of the `count` references from position `first` on.
    #[inline]
    pub fn leaf(bounds: Aabb, first: usize, count: u32) -> Self {
        Self::of(bounds, Self::LEAF | first as u32, count)
    }

    /// The parent of `children`, the pair at `index`.
    #[inline]
    pub fn inner(children: &[Self; 2], index: usize) -> Self {
        let [a, b] = [children[0].vectors(), children[1].vectors()];
        let bounds = Aabb::new(Vec3A::from_vec4(a[0].min(b[0])), Vec3A::from_vec4(a[1].max(b[1])));
        Self::of(bounds, index as u32, children[0].count + children[1].count)
    }

    /// Two stores of 16 bytes: whoever loads the node soon after must not wait for six.
    #[inline]
    fn of(bounds: Aabb, link: u32, count: u32) -> Self {
        let lower = bounds.min.extend(f32::from_bits(link));
        let upper = bounds.max.extend(f32::from_bits(count));
        // SAFETY: both are 32 bytes of floats and integers, of which any bits are valid.
        unsafe { std::mem::transmute::<[Vec4; 2], Self>([lower, upper]) }
    }

    /// The lower and the upper corner, each in one load, with integers for their fourth floats: fit to be compared,
    /// but slow to calculate with, as most are subnormal.
    #[inline]
    fn vectors(&self) -> [Vec4; 2] {
        // SAFETY: as in `of`.
        unsafe { std::mem::transmute::<Self, [Vec4; 2]>(*self) }
    }

    /// The box.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        Aabb::new(Vec3A::from_array(self.min), Vec3A::from_array(self.max))
    }

    /// The box, to be copied: as with [`Node::vectors`], to calculate with it is slow.
    #[inline]
    pub fn bounds_to_copy(&self) -> Aabb {
        let [lower, upper] = self.vectors();
        Aabb::new(Vec3A::from_vec4(lower), Vec3A::from_vec4(upper))
    }

    /// Grows with the area of an inner node and is negative for leaves; no branch depends on which it is.
    #[inline]
    pub fn area_order(&self) -> i32 {
        let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| self.max[axis] - self.min[axis]);
        // As in `Aabb::half_area`; positive floats are ordered as their bits are.
        ((x * (y + z) + y * z).to_bits() | self.link & Self::LEAF) as i32
    }

    /// The lower corner and, three floats on, the upper one.
    #[inline]
    pub fn corners(&self) -> [[f32; 3]; 2] {
        [self.min, self.max]
    }

    /// The same subtree with another box: the part of it inside a clip box.
    #[inline]
    pub fn with_bounds(self, bounds: Aabb) -> Self {
        Self::of(bounds, self.link, self.count)
    }

    /// The same subtree in a tree whose pairs have moved up.
    #[inline]
    pub fn moved(self, pairs: u32) -> Self {
        Self { link: if self.is_leaf() { self.link } else { self.link + pairs }, ..self }
    }

    /// True for a run of references that the tree does not part.
    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.link & Self::LEAF != 0
    }

    /// Names the subtree within its tree.
    #[inline]
    pub fn key(&self) -> (u32, u32) {
        (self.count, self.link)
    }

    /// The positions of a leaf's references.
    #[inline]
    pub fn run(&self) -> std::ops::Range<usize> {
        debug_assert!(self.is_leaf());
        let first = (self.link & !Self::LEAF) as usize;
        first..first + self.count as usize
    }

    /// The index of an inner node's pair of children.
    #[inline]
    pub fn pair(&self) -> Option<usize> {
        (!self.is_leaf()).then_some(self.link as usize)
    }
}

/// A binary tree whose leaves are runs of references.
#[derive(Default)]
pub(super) struct BinaryTree {
    /// `None` without triangles.
    pub root: Option<Node>,
    /// Pairs of siblings.
    pub pairs: Vec<[Node; 2]>,
}

impl BinaryTree {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.pairs.len() * size_of::<[Node; 2]>()
    }

    /// The children of an inner node.
    #[inline]
    pub fn children(&self, node: &Node) -> &[Node; 2] {
        debug_assert!(!node.is_leaf());
        &self.pairs[node.link as usize]
    }

    /// The positions of the references below a node of an LBVH, where they are a run.
    #[inline]
    pub fn run(&self, node: &Node) -> std::ops::Range<usize> {
        let mut first = *node;
        while !first.is_leaf() {
            first = self.children(&first)[0];
        }
        let start = first.run().start;
        start..start + node.count as usize
    }

    /// Asks for the children of a node to be brought near: they are likely to be opened soon.
    #[inline]
    pub fn prefetch(&self, node: &Node) {
        if let Some(pair) = node.pair() {
            super::prefetch::line(&self.pairs, pair);
        }
    }
}
