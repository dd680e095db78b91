//! Binary trees over single triangles: the auxiliary BVH.

use crate::geometry::Aabb;
use glam::Vec3A;

/// A subtree: its box, how many triangles it holds, and where they are. Two of them fill a cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Node {
    min: [f32; 3],
    /// One triangle: its id. More: index of the pair of children in [`BinaryTree::pairs`].
    link: u32,
    max: [f32; 3],
    /// Triangles below, >= 1.
    pub count: u32,
}

impl Node {
    /// A node without meaning, to size arrays with.
    pub const ZERO: Self = Self { min: [0.0; 3], link: 0, max: [0.0; 3], count: 0 };

    /// The leaf of triangle `prim`.
    #[inline]
    pub fn leaf(bounds: Aabb, prim: u32) -> Self {
        Self { min: bounds.min.to_array(), link: prim, max: bounds.max.to_array(), count: 1 }
    }

    /// The parent of the pair at `index`.
    #[inline]
    pub fn inner(children: &[Self; 2], index: usize) -> Self {
        let bounds = children[0].bounds().union(children[1].bounds());
        let count = children[0].count + children[1].count;
        Self { min: bounds.min.to_array(), link: index as u32, max: bounds.max.to_array(), count }
    }

    /// The box.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        Aabb::new(Vec3A::from_array(self.min), Vec3A::from_array(self.max))
    }

    /// The same subtree with another box: the part of it inside a clip box.
    #[inline]
    pub fn with_bounds(self, bounds: Aabb) -> Self {
        Self { min: bounds.min.to_array(), max: bounds.max.to_array(), ..self }
    }

    /// True for a single triangle.
    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.count == 1
    }

    /// Names the subtree within its tree.
    #[inline]
    pub fn key(&self) -> (u32, u32) {
        (self.count, self.link)
    }

    /// The triangle of a leaf.
    #[inline]
    pub fn prim(&self) -> u32 {
        debug_assert!(self.is_leaf());
        self.link
    }
}

/// A binary tree whose leaves are single triangles.
#[derive(Default)]
pub(super) struct BinaryTree {
    /// `None` without triangles.
    pub root: Option<Node>,
    /// Pairs of siblings.
    pub pairs: Vec<[Node; 2]>,
}

impl BinaryTree {
    /// Gives the tree room for the pairs over `triangles`.
    pub fn make_room(&mut self, triangles: usize) {
        super::pages::resize(&mut self.pairs, triangles.saturating_sub(1), [Node::ZERO; 2]);
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.pairs.capacity() * size_of::<[Node; 2]>()
    }

    /// The children of an inner node.
    #[inline]
    pub fn children(&self, node: &Node) -> &[Node; 2] {
        debug_assert!(!node.is_leaf());
        &self.pairs[node.link as usize]
    }
}
