//! The binary tree that is optimised: two siblings to a cache line, every pair with the way to its parent.

use crate::builders::binary::tagged::TaggedBox;
use crate::geometry::Aabb;
use crate::memory::huge_pages;
use crate::parallel;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// A subtree. Tags: the link; the height in the low bits, the triangles of a leaf above.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LinkedNode(TaggedBox);

/// Two siblings.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Pair(pub [LinkedNode; 2]);

/// In a link: where a leaf's triangles are, not a pair's index.
const LEAF: u32 = 1 << 31;
/// Below this bit of the fourth lane of the upper corner is the height, from it on the triangles of a leaf.
const COUNT_SHIFT: u32 = 8;

impl LinkedNode {
    /// The leaf of `count` triangles, whose ids begin at `first` in [`Tree::prims`].
    pub fn leaf(bounds: Aabb, first: usize, count: usize) -> Self {
        Self(TaggedBox::new(bounds, [LEAF | first as u32, (count as u32) << COUNT_SHIFT]))
    }

    /// The parent of `pair`, which is at `index`.
    #[inline(always)]
    pub fn inner(pair: &Pair, index: usize) -> Self {
        let [a, b] = &pair.0;
        let height = 1 + a.height().max(b.height());
        Self(TaggedBox::new(a.bounds().union(b.bounds()), [index as u32, height]))
    }

    /// The same subtree in a tree whose pairs and triangles have moved up.
    #[inline(always)]
    pub fn moved(self, pairs: usize, prims: usize) -> Self {
        let by = if self.pair().is_some() { pairs } else { prims };
        Self(self.0.with_first(self.0.first() + by as u32))
    }

    /// The box, with tags in its fourth lanes, which are subtracted with the others but never multiplied.
    #[inline(always)]
    pub fn bounds(&self) -> Aabb {
        self.0.bounds_with_tags()
    }

    /// Half the surface area of the box.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        self.bounds().half_area()
    }

    /// Levels of inner nodes from here down.
    #[inline(always)]
    pub fn height(&self) -> u32 {
        self.0.second() & ((1 << COUNT_SHIFT) - 1)
    }

    /// Where the children are; `None` for a leaf.
    #[inline(always)]
    pub fn pair(&self) -> Option<usize> {
        let link = self.0.first();
        (link & LEAF == 0).then_some(link as usize)
    }

    /// Where a leaf's triangles are in [`Tree::prims`].
    #[inline(always)]
    pub fn run(&self) -> Range<usize> {
        debug_assert!(self.pair().is_none());
        let first = (self.0.first() & !LEAF) as usize;
        first..first + self.count() as usize
    }

    /// Triangles of a leaf.
    #[inline(always)]
    pub fn count(&self) -> u32 {
        self.0.second() >> COUNT_SHIFT
    }
}

impl Pair {
    /// A place without nodes.
    pub const UNUSED: Self = Self([LinkedNode(TaggedBox::ZERO); 2]);
}

/// A binary tree over leaves of up to four triangles. Node `i` is half `i % 2` of pair `i / 2`; the root is
/// node 0, whose sibling is not in use. In pairs that came from a build siblings and the subtrees below are near
/// each other.
#[derive(Default)]
pub(crate) struct Tree {
    /// The nodes.
    pub pairs: Vec<Pair>,
    /// The triangles of the leaves.
    pub prims: Vec<u32>,
    /// The parents of the pairs, as nodes.
    parents: Vec<AtomicU32>,
}

/// Pairs that one task tells their parents.
const CHUNK: usize = 1 << 14;

/// The root's index.
pub(crate) const ROOT: u32 = 0;

impl Tree {
    /// Becomes empty but for a root to be placed, with room for what most trees over `n` triangles need.
    pub fn clear(&mut self, n: usize) {
        self.pairs.clear();
        self.prims.clear();
        huge_pages::reserve(&mut self.pairs, n / 2 + 64, "the tree to be optimised");
        huge_pages::reserve(&mut self.prims, n + n / 4 + 64, "references of the tree to be optimised");
        self.pairs.push(Pair::UNUSED);
    }

    /// Sets the root and tells all pairs their parents.
    pub fn finish(&mut self, root: LinkedNode) {
        let what = "parents in the tree to be optimised";
        huge_pages::resize_with(&mut self.parents, self.pairs.len(), AtomicU32::default, what);
        self.pairs[0].0[0] = root;
        let Self { pairs, parents, .. } = self;
        // Every pair has one parent but the first, which the root's unused sibling takes for its own.
        parallel::for_each(pairs.chunks(CHUNK).enumerate(), |(chunk, pairs)| {
            for (index, node) in (2 * CHUNK * chunk..).zip(pairs.iter().flat_map(|pair| &pair.0)) {
                if let Some(pair) = node.pair() {
                    parents[pair].store(index as u32, Relaxed);
                }
            }
        });
        *self.parents[0].get_mut() = ROOT;
    }

    /// Node `index`.
    #[inline(always)]
    pub fn node(&self, index: u32) -> &LinkedNode {
        &self.pairs[index as usize / 2].0[index as usize % 2]
    }

    /// The parent of node `index`, which is not the root.
    #[inline(always)]
    pub fn parent(&self, index: u32) -> u32 {
        self.parents[index as usize / 2].load(Relaxed)
    }

    /// Puts `node` at `index`; its children learn of it.
    #[inline(always)]
    pub fn place(&mut self, index: u32, node: LinkedNode) {
        self.pairs[index as usize / 2].0[index as usize % 2] = node;
        if let Some(pair) = node.pair() {
            *self.parents[pair].get_mut() = index;
        }
    }

    /// Node `index` with the box and height of its children.
    #[inline(always)]
    pub fn fitted(&self, index: u32) -> LinkedNode {
        let node = *self.node(index);
        node.pair().map_or(node, |pair| LinkedNode::inner(&self.pairs[pair], pair))
    }
}
