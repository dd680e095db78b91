//! The node of a binary tree.

use super::tagged::TaggedBox;
use crate::geometry::Aabb;

/// A subtree: its box, the number of references below, and where they are. Two nodes fill a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Node(
    /// Tags: the link, and the number of references below, >= 1. The link of a leaf is [`Node::LEAF`] and the position
    /// of its first reference in the order; any other is the index of the pair of children.
    TaggedBox,
);

impl Node {
    const LEAF: u32 = 1 << 31;
    /// Of a link to a pair that has no place yet; there are never as many pairs.
    const UNPLACED: u32 = 1 << 30;

    /// Of the link of a finished leaf; there are never as many references.
    const FINISHED: u32 = 1 << 30;

    /// A node without meaning, to size arrays with.
    pub const ZERO: Self = Self(TaggedBox::ZERO);

    /// The leaf of the `count` references from position `first` on.
    #[inline]
    pub fn leaf(bounds: Aabb, first: usize, count: u32) -> Self {
        Self(TaggedBox::new(bounds, [Self::LEAF | first as u32, count]))
    }

    /// The parent of `children`, the pair at `index`.
    #[inline]
    pub fn inner(children: &[Self; 2], index: usize) -> Self {
        let bounds = children[0].bounds().union(children[1].bounds());
        Self::of_pair(bounds, index, children[0].count() + children[1].count())
    }

    /// The inner node of the pair at `index` with the given box and count.
    #[inline]
    pub fn of_pair(bounds: Aabb, index: usize, count: u32) -> Self {
        Self(TaggedBox::new(bounds, [index as u32, count]))
    }

    /// The box.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        self.0.bounds()
    }

    /// References below, >= 1.
    #[inline]
    pub fn count(&self) -> u32 {
        self.0.second()
    }

    #[inline]
    fn link(&self) -> u32 {
        self.0.first()
    }

    /// The lower face along an axis.
    #[inline]
    pub fn lower(&self, axis: usize) -> f32 {
        self.0.corners()[0][axis]
    }

    /// The upper face along an axis.
    #[inline]
    pub fn upper(&self, axis: usize) -> f32 {
        self.0.corners()[1][axis]
    }

    /// Twice the centroid's coordinate along an axis.
    #[inline]
    pub fn center2(&self, axis: usize) -> f32 {
        self.lower(axis) + self.upper(axis)
    }

    /// The lower corner and the upper one, each followed by a tag: to be loaded lane by lane.
    #[inline]
    pub fn corners(&self) -> [&[f32; 4]; 2] {
        self.0.corners()
    }

    /// A finished leaf, whose wide nodes and blocks have been made, of the `count` references from position `first` on.
    #[inline]
    pub fn finished(bounds: Aabb, first: usize, count: u32) -> Self {
        Self::leaf(bounds, Self::FINISHED as usize | first, count)
    }

    /// Whether it is one.
    #[inline]
    pub fn is_finished(&self) -> bool {
        self.link() & (Self::LEAF | Self::FINISHED) == Self::LEAF | Self::FINISHED
    }

    /// The same subtree with another box: the part of it inside a clip box.
    #[inline]
    pub fn with_bounds(self, bounds: Aabb) -> Self {
        Self(TaggedBox::new(bounds, [self.link(), self.count()]))
    }

    /// Appends the pair of two subtrees; returns their parent.
    #[inline]
    pub fn join(children: [Self; 2], pairs: &mut Vec<[Self; 2]>) -> Self {
        pairs.push(children);
        Self::inner(&children, pairs.len() - 1)
    }

    /// The same where either may be missing: a lone one takes the parent's place.
    #[inline]
    pub fn join_any(halves: [Option<Self>; 2], pairs: &mut Vec<[Self; 2]>) -> Option<Self> {
        match halves {
            [Some(left), Some(right)] => Some(Self::join([left, right], pairs)),
            [only, None] | [None, only] => only,
        }
    }

    /// The same subtree in a tree whose pairs have moved up.
    #[inline]
    pub fn moved(self, pairs: u32) -> Self {
        self.appended(pairs, 0)
    }

    /// The same subtree in a tree whose pairs have moved up, and whose references follow `references` others.
    #[inline]
    pub fn appended(self, pairs: u32, references: u32) -> Self {
        let by = if self.is_leaf() { references } else { pairs };
        Self(TaggedBox::new(self.bounds(), [self.link() + by, self.count()]))
    }

    /// The parent of this node and `other`, the pair at `index` of those without a place, or, if `other` is this node,
    /// itself: there is no branch, as none could foresee which clusters are merged.
    #[inline(always)]
    pub fn merged_if(&self, is_merged: bool, other: &Self, index: usize) -> Self {
        let link = if is_merged { Self::UNPLACED | index as u32 } else { self.link() };
        let count = self.count() + if is_merged { other.count() } else { 0 };
        Self(TaggedBox::new(self.bounds().union(other.bounds()), [link, count]))
    }

    /// The same subtree where the pairs without a place begin at `first`.
    #[inline(always)]
    pub fn placed(self, first: u32) -> Self {
        let is_placed = self.link() & (Self::LEAF | Self::UNPLACED) != Self::UNPLACED;
        let link = if is_placed { self.link() } else { (self.link() & !Self::UNPLACED) + first };
        Self(self.0.with_first(link))
    }

    /// True for a leaf: a run of references that the tree does not partition.
    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.link() & Self::LEAF != 0
    }

    /// The positions of a leaf's references.
    #[inline]
    pub fn run(&self) -> std::ops::Range<usize> {
        debug_assert!(self.is_leaf());
        let first = (self.link() & !(Self::LEAF | Self::FINISHED)) as usize;
        first..first + self.count() as usize
    }

    /// The index of the pair of children of a node that is known to be an inner one.
    #[inline]
    pub fn pair_of_inner(&self) -> usize {
        debug_assert!(!self.is_leaf());
        self.link() as usize
    }

    /// The index of an inner node's pair of children; `None` for a leaf.
    #[inline]
    pub fn pair(&self) -> Option<usize> {
        (!self.is_leaf()).then_some(self.link() as usize)
    }
}

/// A subtree whose triangles are a run, with the position of the first.
#[derive(Clone, Copy)]
pub(crate) struct NodeRun {
    /// Its root.
    pub node: Node,
    /// The position of its first triangle.
    pub first: u32,
}

impl NodeRun {
    /// Two subtrees whose triangles follow each other from a position on.
    #[inline(always)]
    pub fn in_a_row([left, right]: [Node; 2], first: u32) -> [Self; 2] {
        let after = first + left.count();
        [Self { node: left, first }, Self { node: right, first: after }]
    }
}
