//! Binary trees over runs of references in Morton order: the auxiliary BVH.

pub(crate) mod subtrees;

use crate::geometry::Aabb;
use glam::{Vec3A, Vec4, Vec4Swizzles};

/// A subtree: its box, how many references it holds, and where they are. Two of them fill a cache line.
///
/// Numbers lie in the fourth lanes of the corners, so that a node is two vectors wherever it is: written in parts
/// and read as a whole, it would wait for the parts to reach the cache.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Node {
    /// Lower corner and link.
    ///
    /// The link of a leaf is [`Node::LEAF`] and the position of its first reference in the order, any other the
    /// index of the pair of children in [`BinaryTree::pairs`].
    lower: Vec4,
    /// Upper corner and number of references below, >= 1.
    upper: Vec4,
}

impl Node {
    const LEAF: u32 = 1 << 31;

    /// A node without meaning, to size arrays with.
    pub const ZERO: Self = Self { lower: Vec4::ZERO, upper: Vec4::ZERO };

    #[inline]
    fn new(bounds: Aabb, link: u32, count: u32) -> Self {
        let with = |corner: Vec3A, number| corner.extend(f32::from_bits(number));
        Self { lower: with(bounds.min, link), upper: with(bounds.max, count) }
    }

    /// The leaf of the `count` references from position `first` on.
    #[inline]
    pub fn leaf(bounds: Aabb, first: usize, count: u32) -> Self {
        Self::new(bounds, Self::LEAF | first as u32, count)
    }

    /// The parent of `children`, the pair at `index`.
    #[inline]
    pub fn inner(children: &[Self; 2], index: usize) -> Self {
        let bounds = children[0].bounds().union(children[1].bounds());
        Self::new(bounds, index as u32, children[0].count() + children[1].count())
    }

    /// The inner node of the pair at `index`, which has the given box and count.
    #[inline]
    pub fn of_pair(bounds: Aabb, index: usize, count: u32) -> Self {
        Self::new(bounds, index as u32, count)
    }

    /// The box.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        // Numbers in the fourth lanes would be denormal floats, which are slow.
        let corner = |corner: Vec4| Vec3A::from_vec4(corner.xyzz());
        Aabb::new(corner(self.lower), corner(self.upper))
    }

    /// References below, >= 1.
    #[inline]
    pub fn count(&self) -> u32 {
        self.upper.w.to_bits()
    }

    #[inline]
    fn link(&self) -> u32 {
        self.lower.w.to_bits()
    }

    /// The lower face along an axis.
    #[inline]
    pub fn lower(&self, axis: usize) -> f32 {
        self.lower[axis]
    }

    /// The upper face along an axis.
    #[inline]
    pub fn upper(&self, axis: usize) -> f32 {
        self.upper[axis]
    }

    /// The lower corner and the upper one, each followed by a number of another meaning: where they lie, to be read
    /// into all lanes of vectors.
    #[inline]
    pub fn corners(&self) -> [&[f32; 4]; 2] {
        [self.lower.as_ref(), self.upper.as_ref()]
    }

    /// The same subtree with another box: the part of it inside a clip box.
    #[inline]
    pub fn with_bounds(self, bounds: Aabb) -> Self {
        Self::new(bounds, self.link(), self.count())
    }

    /// The same subtree in a tree whose pairs have moved up.
    #[inline]
    pub fn moved(self, pairs: u32) -> Self {
        if self.is_leaf() { self } else { Self::new(self.bounds(), self.link() + pairs, self.count()) }
    }

    /// True for a run of references that the tree does not part.
    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.link() & Self::LEAF != 0
    }

    /// Names the subtree within its tree.
    #[inline]
    pub fn key(&self) -> (u32, u32) {
        (self.count(), self.link())
    }

    /// The positions of a leaf's references.
    #[inline]
    pub fn run(&self) -> std::ops::Range<usize> {
        debug_assert!(self.is_leaf());
        let first = (self.link() & !Self::LEAF) as usize;
        first..first + self.count() as usize
    }

    /// The index of an inner node's pair of children.
    #[inline]
    pub fn pair(&self) -> Option<usize> {
        (!self.is_leaf()).then_some(self.link() as usize)
    }
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.bounds() == other.bounds() && self.key() == other.key()
    }
}

/// A binary tree whose leaves are runs of references.
#[derive(Default)]
pub(crate) struct BinaryTree {
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
        &self.pairs[node.link() as usize]
    }

    /// The positions of the references below a node of an LBVH, where they are a run.
    #[inline]
    pub fn run(&self, node: &Node) -> std::ops::Range<usize> {
        let mut first = *node;
        while !first.is_leaf() {
            first = self.children(&first)[0];
        }
        let start = first.run().start;
        start..start + node.count() as usize
    }

    /// Asks for the children of a node to be brought near: they are likely to be opened soon.
    #[inline]
    pub fn prefetch(&self, node: &Node) {
        if let Some(pair) = node.pair() {
            crate::builders::lbvh::prefetch::line(&self.pairs, pair);
        }
    }
}
