//! The binary tree that is optimised: two siblings to a cache line, every pair with the way to its parent.

use super::super::pages;
use crate::geometry::Aabb;
use glam::{Vec3A, Vec4};

/// A subtree: its box and what is below. The fourth lanes carry bits that no arithmetic looks at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Lower corner, and the link.
    lower: Vec4,
    /// Upper corner, and the height.
    upper: Vec4,
}

/// Two siblings.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Pair(pub [Node; 2]);

/// In a link: a triangle's id, not a pair's index.
const LEAF: u32 = 1 << 31;
/// In a link to a pair: the subtree is a leaf of the wide tree, which reinsertion leaves whole.
const CLOSED: u32 = 1 << 30;

impl Node {
    fn new(bounds: Aabb, link: u32, height: u32) -> Self {
        let lane = f32::from_bits;
        Self { lower: bounds.min.extend(lane(link)), upper: bounds.max.extend(lane(height)) }
    }

    /// A reference to triangle `prim`.
    pub fn leaf(bounds: Aabb, prim: u32) -> Self {
        Self::new(bounds, LEAF | prim, 0)
    }

    /// The parent of `pair`, which is at `index`.
    #[inline(always)]
    pub fn inner(pair: &Pair, index: usize) -> Self {
        let [a, b] = &pair.0;
        Self::new(a.bounds().union(b.bounds()), index as u32, 1 + a.height().max(b.height()))
    }

    /// The parent of a pair at `index` that is yet to be made: box and height are to be fitted.
    pub fn to_fit(index: usize) -> Self {
        Self::new(Aabb::EMPTY, index as u32, 0)
    }

    /// The same subtree, closed to reinsertion.
    #[must_use]
    pub fn closed(self) -> Self {
        Self::new(self.bounds(), self.link() | CLOSED, self.height())
    }

    /// The box.
    #[inline(always)]
    pub fn bounds(&self) -> Aabb {
        Aabb::new(Vec3A::from_vec4(self.lower), Vec3A::from_vec4(self.upper))
    }

    /// Half the surface area of the box.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        self.bounds().half_area()
    }

    /// Levels of inner nodes from here down.
    #[inline(always)]
    pub fn height(&self) -> u32 {
        self.upper.w.to_bits()
    }

    #[inline(always)]
    fn link(&self) -> u32 {
        self.lower.w.to_bits()
    }

    /// Where the children are; `None` for a reference to a triangle.
    #[inline(always)]
    pub fn pair(&self) -> Option<usize> {
        let link = self.link();
        (link & LEAF == 0).then_some((link & !CLOSED) as usize)
    }

    /// Where the children are, if reinsertion may look at them.
    #[inline(always)]
    pub fn open_pair(&self) -> Option<usize> {
        let link = self.link();
        (link & (LEAF | CLOSED) == 0).then_some(link as usize)
    }

    /// The triangle of a leaf.
    pub fn prim(&self) -> u32 {
        debug_assert!(self.pair().is_none());
        self.link() & !LEAF
    }
}

impl Pair {
    /// A place without nodes. No node links to pair 0, which holds the root.
    pub const UNUSED: Self = Self([Node { lower: Vec4::ZERO, upper: Vec4::ZERO }; 2]);

    /// False for [`Pair::UNUSED`].
    #[inline(always)]
    pub fn is_used(&self) -> bool {
        self.0[0].link() != 0
    }
}

/// A binary tree over triangle references. Node `i` is half `i % 2` of pair `i / 2`; the root is node 0, whose
/// sibling is not in use.
#[derive(Default)]
pub(super) struct Tree {
    /// The nodes.
    pub pairs: Vec<Pair>,
    /// The parents of the pairs, as nodes.
    parents: Vec<u32>,
}

/// The root's index.
pub(super) const ROOT: u32 = 0;

impl Tree {
    /// Makes room for `pairs` pairs, the root's included; they hold what they held.
    pub fn make_room(&mut self, pairs: usize) {
        pages::resize(&mut self.pairs, pairs, Pair::UNUSED);
        pages::resize(&mut self.parents, pairs, ROOT);
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.pairs.capacity() * size_of::<Pair>() + self.parents.capacity() * size_of::<u32>()
    }

    /// Node `index`.
    #[inline(always)]
    pub fn node(&self, index: u32) -> &Node {
        &self.pairs[index as usize / 2].0[index as usize % 2]
    }

    /// The parent of node `index`, which is not the root.
    #[inline(always)]
    pub fn parent(&self, index: u32) -> u32 {
        self.parents[index as usize / 2]
    }

    /// Puts `node` at `index`; its children learn of it.
    #[inline(always)]
    pub fn place(&mut self, index: u32, node: Node) {
        self.pairs[index as usize / 2].0[index as usize % 2] = node;
        if let Some(pair) = node.pair() {
            self.parents[pair] = index;
        }
    }

    /// Node `index` with the box and height of its children, unless it is closed.
    #[inline(always)]
    pub fn fitted(&self, index: u32) -> Node {
        let node = *self.node(index);
        node.open_pair().map_or(node, |pair| Node::inner(&self.pairs[pair], pair))
    }

    /// Fits all nodes and tells all pairs their parents, where pairs come after their parents'.
    pub fn fit_all(&mut self) {
        for pair in (1..self.pairs.len() as u32).rev() {
            if self.pairs[pair as usize].is_used() {
                self.place(2 * pair, self.fitted(2 * pair));
                self.place(2 * pair + 1, self.fitted(2 * pair + 1));
            }
        }
        self.place(ROOT, self.fitted(ROOT));
    }
}
