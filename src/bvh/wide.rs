//! The wide (multi-) BVH: N-wide nodes in structure-of-arrays form and leaf blocks of four triangles
//! (paper 4.5; leaf model of Table 1's caption).

use super::limits::{MAX_BLOCKS, MAX_LEAF_BLOCKS};
use crate::geometry::{Aabb, Mesh};
use glam::{Mat4, Vec3A, Vec4};

/// A packed reference to a child: an inner node, a leaf of 1 to 7 consecutive blocks, or nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Link(u32);

/// A [`Link`], unpacked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Child {
    /// An unused slot.
    Empty,
    /// Index into [`WideBvh::nodes`].
    Inner(usize),
    /// Consecutive blocks of [`WideBvh::blocks`].
    Leaf {
        /// First block.
        first: usize,
        /// Number of blocks, 1 to [`MAX_LEAF_BLOCKS`].
        count: usize,
    },
}

impl Link {
    /// Bit that tells a leaf (or nothing) from an inner node.
    pub const LEAF_BIT: u32 = 1 << 31;
    const COUNT_SHIFT: u32 = MAX_BLOCKS.trailing_zeros();
    const INDEX_MASK: u32 = MAX_BLOCKS as u32 - 1;

    /// The unused slot.
    pub const EMPTY: Self = Self(u32::MAX);

    /// Refers to inner node `index`.
    #[inline]
    pub fn inner(index: usize) -> Self {
        debug_assert!(index < Self::LEAF_BIT as usize);
        Self(index as u32)
    }

    /// Refers to `count` blocks from `first`.
    #[inline]
    pub fn leaf(first: usize, count: usize) -> Self {
        debug_assert!((1..=MAX_LEAF_BLOCKS).contains(&count) && first < MAX_BLOCKS);
        Self(Self::LEAF_BIT | ((count as u32 - 1) << Self::COUNT_SHIFT) | first as u32)
    }

    /// The packed bits: below [`Link::LEAF_BIT`] an inner node's index.
    #[inline]
    pub fn bits(self) -> u32 {
        self.0
    }

    /// The link packed in `bits`, as [`Link::bits`] gave them.
    #[inline]
    pub fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// True for an unused slot.
    #[inline]
    pub fn is_empty(self) -> bool {
        self == Self::EMPTY
    }

    /// True for an inner node.
    #[inline]
    pub fn is_inner(self) -> bool {
        self.0 & Self::LEAF_BIT == 0
    }

    /// The same reference after its node moved `nodes` or its blocks `blocks` places up.
    #[inline]
    #[must_use]
    pub fn moved(self, nodes: usize, blocks: usize) -> Self {
        match self.get() {
            Child::Empty => self,
            Child::Inner(index) => Self::inner(index + nodes),
            Child::Leaf { first, count } => Self::leaf(first + blocks, count),
        }
    }

    /// The reference, unpacked.
    #[inline]
    pub fn get(self) -> Child {
        if self.is_empty() {
            Child::Empty
        } else if self.is_inner() {
            Child::Inner(self.0 as usize)
        } else {
            Child::Leaf {
                first: (self.0 & Self::INDEX_MASK) as usize,
                count: ((self.0 >> Self::COUNT_SHIFT) & 7) as usize + 1,
            }
        }
    }
}

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

    /// Fills `slot`.
    #[inline]
    pub fn set(&mut self, slot: usize, bounds: Aabb, link: Link) {
        for axis in 0..3 {
            self.lower[axis][slot] = bounds.min[axis];
            self.upper[axis][slot] = bounds.max[axis];
        }
        self.links[slot] = link;
    }

    /// The box of `slot`.
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

impl WideNode<4> {
    /// A node of at most four children.
    #[inline]
    pub fn of(children: &[(Aabb, Link)]) -> Self {
        let mut boxes = [Aabb::EMPTY; 4];
        let mut links = [Link::EMPTY; 4];
        for (slot, &(bounds, link)) in children.iter().enumerate() {
            boxes[slot] = bounds;
            links[slot] = link;
        }
        Self::of_slots(boxes, links)
    }

    /// A node of the given slots, the used ones of which come first.
    #[inline(always)]
    pub fn of_slots(boxes: [Aabb; 4], links: [Link; 4]) -> Self {
        let [a, b, c, d] = boxes;
        let [x, y, z] = transposed([a.min, b.min, c.min, d.min]);
        let lower = [x.into(), y.into(), z.into()];
        let [x, y, z] = transposed([a.max, b.max, c.max, d.max]);
        Self { lower, upper: [x.into(), y.into(), z.into()], links }
    }
}

/// The x, the y and the z of four points.
#[inline(always)]
fn transposed([a, b, c, d]: [Vec3A; 4]) -> [Vec4; 3] {
    // Not by `map`, which is not always inlined.
    let rows = Mat4::from_cols(a.extend(0.0), b.extend(0.0), c.extend(0.0), d.extend(0.0)).transpose();
    [rows.x_axis, rows.y_axis, rows.z_axis]
}

/// Four triangles in structure-of-arrays form, ready for intersection: first corner and two edges.
/// Unused lanes hold zeros (never hit) and id [`crate::geometry::Hit::NONE`]; used lanes come first.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct TriangleBlock {
    /// First corner, `v0[axis][lane]`.
    pub v0: [[f32; 4]; 3],
    /// First corner minus second.
    pub e1: [[f32; 4]; 3],
    /// Third corner minus first.
    pub e2: [[f32; 4]; 3],
    /// Triangle ids.
    pub prims: [u32; 4],
}

impl TriangleBlock {
    /// A block without triangles.
    pub const EMPTY: Self =
        Self { v0: [[0.0; 4]; 3], e1: [[0.0; 4]; 3], e2: [[0.0; 4]; 3], prims: [u32::MAX; 4] };

    /// A block of one to four triangles of `mesh`.
    #[inline]
    pub fn of(mesh: &Mesh, prims: &[u32]) -> Self {
        let last = prims.len() - 1;
        Self::of_first(prims.len(), std::array::from_fn(|lane| prims[lane.min(last)]), mesh)
    }

    /// A block of the first `count` triangles, one to four, of `prims`, all of them triangles of `mesh`.
    #[inline]
    pub fn of_first(count: usize, prims: [u32; 4], mesh: &Mesh) -> Self {
        // Corners are fetched for all lanes: a branch on their number could not be foreseen.
        let [p, q, r, s] = prims;
        let corners = [mesh.corners(p), mesh.corners(q), mesh.corners(r), mesh.corners(s)];
        Self::of_corners(count, prims, corners)
    }

    /// A block of the first `count` triangles, one to four, of `prims`, whose corners are given.
    #[inline(always)]
    pub fn of_corners(count: usize, prims: [u32; 4], [p, q, r, s]: [[Vec3A; 3]; 4]) -> Self {
        let a = transposed([p[0], q[0], r[0], s[0]]);
        let b = transposed([p[1], q[1], r[1], s[1]]);
        let c = transposed([p[2], q[2], r[2], s[2]]);
        let used = Vec4::new(0.0, 1.0, 2.0, 3.0).cmplt(Vec4::splat(count as f32));
        let lanes = |v: Vec4| Vec4::select(used, v, Vec4::ZERO).to_array();
        Self {
            v0: [lanes(a[0]), lanes(a[1]), lanes(a[2])],
            e1: [lanes(a[0] - b[0]), lanes(a[1] - b[1]), lanes(a[2] - b[2])],
            e2: [lanes(c[0] - a[0]), lanes(c[1] - a[1]), lanes(c[2] - a[2])],
            prims: std::array::from_fn(|lane| if lane < count { prims[lane] } else { u32::MAX }),
        }
    }

    /// Fills `lane`.
    #[inline]
    pub fn set(&mut self, lane: usize, corners: [Vec3A; 3], prim: u32) {
        let e1 = corners[0] - corners[1];
        let e2 = corners[2] - corners[0];
        for axis in 0..3 {
            self.v0[axis][lane] = corners[0][axis];
            self.e1[axis][lane] = e1[axis];
            self.e2[axis][lane] = e2[axis];
        }
        self.prims[lane] = prim;
    }

    /// The ids in use.
    #[inline]
    pub fn ids(&self) -> impl Iterator<Item = u32> + '_ {
        self.prims.iter().copied().filter(|&prim| prim != u32::MAX)
    }
}

/// A wide BVH with its leaf data: all that traversal needs.
#[derive(Clone, Debug, PartialEq)]
pub struct WideBvh<const N: usize> {
    /// The root; [`Link::EMPTY`] for a tree without triangles, a leaf for a very small one.
    pub root: Link,
    /// Box of everything below the root.
    pub bounds: Aabb,
    /// Inner nodes.
    pub nodes: Vec<WideNode<N>>,
    /// Leaf blocks.
    pub blocks: Vec<TriangleBlock>,
}

/// The 4-wide tree of the paper.
pub type Bvh4 = WideBvh<4>;
/// The 8-wide tree that Embree's users get by default.
pub type Bvh8 = WideBvh<8>;

impl<const N: usize> Default for WideBvh<N> {
    fn default() -> Self {
        Self { root: Link::EMPTY, bounds: Aabb::EMPTY, nodes: Vec::new(), blocks: Vec::new() }
    }
}

impl<const N: usize> WideBvh<N> {
    /// Bytes of nodes and leaf blocks.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..])
    }

    /// The triangle ids of a leaf's blocks.
    pub fn leaf_ids(&self, first: usize, count: usize) -> impl Iterator<Item = u32> + '_ {
        self.blocks[first..first + count].iter().flat_map(TriangleBlock::ids)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_round_trip() {
        assert_eq!(Link::EMPTY.get(), Child::Empty);
        assert_eq!(Link::inner(0).get(), Child::Inner(0));
        assert_eq!(Link::inner((1 << 31) - 1).get(), Child::Inner((1 << 31) - 1));
        for count in 1..=MAX_LEAF_BLOCKS {
            for first in [0, 5, MAX_BLOCKS - 1] {
                assert_eq!(Link::leaf(first, count).get(), Child::Leaf { first, count });
            }
        }
    }

    #[test]
    fn layouts_are_what_kernels_assume() {
        assert_eq!(size_of::<WideNode<4>>(), 128);
        assert_eq!(size_of::<WideNode<8>>(), 256);
        assert_eq!(size_of::<TriangleBlock>(), 160);
    }
}
