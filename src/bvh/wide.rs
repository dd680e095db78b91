//! The wide (multi-) BVH: N-wide nodes in structure-of-arrays form and leaf blocks of four triangles
//! (paper 4.5; leaf model of Table 1's caption).

use super::block::{TriangleBlock, transposed};
use super::id_block::LeafBlock;
use super::limits::check_width;
use super::link::{Child, Link};
use crate::geometry::Aabb;
use glam::Vec3A;

/// An inner node: the boxes of up to `N` children, one array per plane, and the links. Used slots come
/// first; unused ones hold an inverted infinite box, which no ray enters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct WideNode<const N: usize> {
    /// `lower[axis][slot]`.
    pub lower: [[f32; N]; 3],
    /// `upper[axis][slot]`.
    pub upper: [[f32; N]; 3],
    /// The children.
    pub links: [Link; N],
}

impl<const N: usize> WideNode<N> {
    /// A node without children.
    pub const EMPTY: Self =
        Self { lower: [[f32::INFINITY; N]; 3], upper: [[f32::NEG_INFINITY; N]; 3], links: [Link::EMPTY; N] };

    /// Fills `slot`; used ones come first.
    ///
    /// # Panics
    /// If `slot` is `N` or more.
    #[inline]
    pub fn set(&mut self, slot: usize, bounds: Aabb, link: Link) {
        for axis in 0..3 {
            self.lower[axis][slot] = bounds.min[axis];
            self.upper[axis][slot] = bounds.max[axis];
        }
        self.links[slot] = link;
    }

    /// The box of `slot`.
    ///
    /// # Panics
    /// If `slot` is `N` or more.
    #[inline]
    pub fn bounds(&self, slot: usize) -> Aabb {
        Aabb::new(
            Vec3A::from_array(self.lower.map(|plane| plane[slot])),
            Vec3A::from_array(self.upper.map(|plane| plane[slot])),
        )
    }

    /// The used slots: box and child.
    pub fn children(&self) -> impl Iterator<Item = (Aabb, Link)> + '_ {
        (0..N).filter(|&slot| !self.links[slot].is_empty()).map(|slot| (self.bounds(slot), self.links[slot]))
    }
}

impl<const N: usize> WideNode<N> {
    /// A node of at most `N` children, each a box and a link that is not empty.
    ///
    /// # Panics
    /// If there are more.
    #[inline]
    pub fn of(children: &[(Aabb, Link)]) -> Self {
        let mut boxes = [Aabb::EMPTY; N];
        let mut links = [Link::EMPTY; N];
        for (slot, &(bounds, link)) in children.iter().enumerate() {
            boxes[slot] = bounds;
            links[slot] = link;
        }
        Self::of_slots(&boxes, links)
    }

    /// A node of the given slots, the used ones of which come first; the box of an unused one is [`Aabb::EMPTY`].
    #[inline(always)]
    pub fn of_slots(boxes: &[Aabb; N], links: [Link; N]) -> Self {
        const { check_width::<N>() };
        let mut node = Self { links, ..Self::EMPTY };
        for slot in (0..N).step_by(4) {
            let [a, b, c, d] = [&boxes[slot], &boxes[slot + 1], &boxes[slot + 2], &boxes[slot + 3]];
            let (lower, upper) =
                (transposed([a.min, b.min, c.min, d.min]), transposed([a.max, b.max, c.max, d.max]));
            for axis in 0..3 {
                lower[axis].write_to_slice(&mut node.lower[axis][slot..slot + 4]);
                upper[axis].write_to_slice(&mut node.upper[axis][slot..slot + 4]);
            }
        }
        node
    }
}

/// A wide BVH with its leaf data, complete for traversal.
#[derive(Clone, Debug, PartialEq)]
pub struct WideBvh<const N: usize, B = TriangleBlock> {
    /// The root; [`Link::EMPTY`] for a tree without triangles, a leaf for a very small one.
    pub root: Link,
    /// Box of everything below the root.
    pub bounds: Aabb,
    /// Inner nodes.
    pub nodes: Vec<WideNode<N>>,
    /// Leaf blocks: triangles, or the numbers of other primitives ([`super::IdBlock`]).
    pub blocks: Vec<B>,
}

/// The 4-wide tree of the paper.
pub type Bvh4 = WideBvh<4>;
/// The 8-wide tree that Embree's users get by default.
pub type Bvh8 = WideBvh<8>;

impl<const N: usize, B> Default for WideBvh<N, B> {
    fn default() -> Self {
        Self { root: Link::EMPTY, bounds: Aabb::EMPTY, nodes: Vec::new(), blocks: Vec::new() }
    }
}

impl<const N: usize, B: LeafBlock> WideBvh<N, B> {
    /// Bytes of nodes and leaf blocks.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..])
    }

    /// The primitives of a leaf's blocks.
    ///
    /// # Panics
    /// If there are no such blocks.
    pub fn leaf_ids(&self, first: usize, count: usize) -> impl Iterator<Item = u32> + '_ {
        self.blocks[first..first + count].iter().flat_map(B::ids)
    }
}

impl<const N: usize> WideBvh<N> {
    /// Whether the tree's box is finite and holds those of the root's children, or the first corners in a root that is
    /// a leaf. Links are in range.
    pub(crate) fn is_bounded(&self) -> bool {
        let holds = |bounds: Aabb| bounds.is_empty() || self.bounds.contains(bounds);
        let is_held = match self.root.get() {
            Child::Empty => return true,
            Child::Inner(root) => self.nodes[root].children().all(|(bounds, _)| holds(bounds)),
            Child::Leaf { first, count } => self.blocks[first..first + count].iter().all(|block| {
                let corner = |lane: usize| Vec3A::from_array(block.v0.map(|axis| axis[lane]));
                let mut lanes = (0..4).filter(|&lane| block.prims[lane] != u32::MAX);
                lanes.all(|lane| holds(Aabb::new(corner(lane), corner(lane))))
            }),
        };
        is_held && self.bounds.min.is_finite() && self.bounds.max.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_are_what_kernels_assume() {
        assert_eq!(size_of::<WideNode<4>>(), 128);
        assert_eq!(size_of::<WideNode<8>>(), 256);
        assert_eq!(size_of::<TriangleBlock>(), 160);
    }
}
