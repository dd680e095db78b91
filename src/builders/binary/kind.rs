//! Whether a subtree becomes a node or a leaf of the wide tree, in the cost model of Table 1: a node costs 1, a
//! leaf its blocks of four triangles.

use super::node::Node;
use crate::bvh::limits::BLOCK;

/// What becomes of a subtree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum Kind {
    /// A node: the subtree is split.
    Inner,
    /// A leaf of several blocks, because a node would cost more. Where the parent has room for more children it is
    /// split nevertheless, as that costs no node.
    SoftLeaf,
    /// A leaf.
    Leaf,
}

/// The cost of a leaf of `count` references in a box of half area `area`.
#[inline(always)]
pub(crate) fn leaf_cost(area: f32, count: u32) -> f32 {
    area * count.div_ceil(BLOCK) as f32
}

/// Whether a leaf costs no more than a node over two leaves, each given by its half area and number of references.
#[inline(always)]
pub(crate) fn leaf_is_cheaper(whole: (f32, u32), [left, right]: [(f32, u32); 2]) -> bool {
    leaf_cost(whole.0, whole.1) <= whole.0 + (leaf_cost(left.0, left.1) + leaf_cost(right.0, right.1))
}

impl Kind {
    /// The kind of `count` references by their number alone.
    #[inline(always)]
    pub fn of_count(count: u32) -> Self {
        if count <= BLOCK { Self::Leaf } else { Self::Inner }
    }

    /// The kind of a single node as a cut: by its number of references, but finished leaves are leaves.
    #[inline(always)]
    pub fn of_lone(node: &Node) -> Self {
        if node.is_finished() { Self::Leaf } else { Self::of_count(node.count()) }
    }

    /// The kind of `node`, where leaves hold at most `max_leaf` triangles. `children` is called only if the answer
    /// depends on them.
    #[inline(always)]
    pub fn of(node: &Node, max_leaf: u32, children: impl FnOnce() -> [Node; 2]) -> Self {
        if node.count() <= BLOCK || node.is_finished() {
            return Self::Leaf;
        }
        if node.count() > max_leaf {
            return Self::Inner;
        }
        let measure = |node: &Node| (node.bounds().half_area(), node.count());
        let [left, right] = children();
        if leaf_is_cheaper(measure(node), [measure(&left), measure(&right)]) {
            Self::SoftLeaf
        } else {
            Self::Inner
        }
    }
}
