//! What builders ask of what they build over: triangles of a mesh, or [`Boxes`](super::boxes::Boxes) of anything
//! else. Each is compiled for itself, so that triangles pay nothing for the choice.

use crate::bvh::limits::BLOCK;
use crate::bvh::{LeafBlock, TriangleBlock};
use crate::geometry::triangle_split::{split_triangle, visible};
use crate::geometry::{Aabb, Mesh};
use crate::memory::prefetch::line;
use crate::memory::stream::Vectors;
use std::ops::Range;

/// Primitives, numbered from 0, each with a box. Implemented by [`Mesh`] and [`Boxes`](super::boxes::Boxes); what other
/// libraries call custom or user geometry becomes boxes. Nobody else implements it: builders rely on boxes that were
/// checked, finite and not empty.
///
/// # Panics
/// Its functions do for a primitive that there is not, unless they say otherwise.
pub trait Geometry: Sync + Checked {
    /// What leaves hold of up to four of them.
    type Block: LeafBlock + Vectors;
    /// A primitive with what finds its box.
    type Item: Copy + Default + Send + 'static;

    /// Number of primitives.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All of them.
    fn prims(&self) -> Range<u32> {
        0..self.len() as u32
    }

    /// The box of primitive `prim`.
    fn bounds_of(&self, prim: u32) -> Aabb;

    /// Calls `f` with the boxes of primitives in order.
    fn for_each(&self, prims: Range<usize>, f: impl FnMut(Aabb));

    /// The block of the first `count` of `prims`, all of them primitives.
    fn block(&self, count: usize, prims: [u32; 4]) -> Self::Block;

    /// The block of one to four primitives.
    ///
    /// # Panics
    /// If there are none, or more.
    #[inline]
    fn block_of(&self, prims: &[u32]) -> Self::Block {
        assert!((1..=BLOCK as usize).contains(&prims.len()), "a block of {} primitives", prims.len());
        let last = prims.len() - 1;
        self.block(prims.len(), std::array::from_fn(|lane| prims[lane.min(last)]))
    }

    /// Looks up a primitive, and prefetches its box.
    fn item(&self, prim: u32) -> Self::Item;

    /// The box of an item.
    fn bounds_of_item(&self, item: &Self::Item) -> Aabb;

    /// The block of the first `count` of four items, and the box of all four.
    fn block_of_items(&self, count: usize, items: [&Self::Item; 4]) -> (Aabb, Self::Block);

    /// Whether splits in space may split primitives.
    fn splits(&self) -> bool;

    /// The boxes of the parts of a primitive in `bounds`, a part of its box, on both sides of a plane; either may
    /// be empty.
    fn split(&self, prim: u32, bounds: Aabb, axis: usize, plane: f32) -> [Aabb; 2];

    /// The box of the part of a primitive in `bounds`, itself a box that is known of the part; none if they do not
    /// meet.
    fn visible(&self, prim: u32, bounds: Aabb) -> Option<Aabb>;

    /// The mesh, of triangles.
    fn triangles(&self) -> Option<&Mesh>;

    /// Prefetches a primitive; any number is allowed.
    fn prefetch(&self, prim: u32);

    /// Prefetches the first corner of a triangle that was prefetched.
    fn prefetch_first_corner(&self, prim: u32);

    /// Prefetches the corners of a triangle that was prefetched.
    fn prefetch_corners(&self, prim: u32);
}

/// Seals [`Geometry`], which no other crate can implement: builders rely on boxes that were checked.
pub trait Checked {}

impl Checked for Mesh {}

impl Geometry for Mesh {
    type Block = TriangleBlock;
    /// Three vertices and the triangle.
    type Item = [u32; 4];

    #[inline(always)]
    fn len(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn bounds_of(&self, prim: u32) -> Aabb {
        self.bounds_of(prim)
    }

    #[inline(always)]
    fn for_each(&self, prims: Range<usize>, mut f: impl FnMut(Aabb)) {
        for triangle in &self.triangles()[prims] {
            f(Aabb::of_triangle(self.corners_of(triangle)));
        }
    }

    #[inline(always)]
    fn block(&self, count: usize, prims: [u32; 4]) -> TriangleBlock {
        TriangleBlock::of_first(count, prims, self)
    }

    #[inline(always)]
    fn item(&self, prim: u32) -> [u32; 4] {
        let [a, b, c] = self.triangles()[prim as usize];
        [a, b, c].iter().for_each(|&vertex| line(self.padded_vertices(), vertex as usize));
        [a, b, c, prim]
    }

    #[inline(always)]
    fn bounds_of_item(&self, &[a, b, c, _]: &[u32; 4]) -> Aabb {
        Aabb::of_triangle(self.corners_of(&[a, b, c]))
    }

    #[inline(always)]
    fn block_of_items(&self, count: usize, [p, q, r, s]: [&[u32; 4]; 4]) -> (Aabb, TriangleBlock) {
        let corners = |&[a, b, c, _]: &[u32; 4]| self.corners_of(&[a, b, c]);
        let prims = [p[3], q[3], r[3], s[3]];
        let [p, q, r, s] = [corners(p), corners(q), corners(r), corners(s)];
        let halves = [
            Aabb::of_triangle(p).union(Aabb::of_triangle(q)),
            Aabb::of_triangle(r).union(Aabb::of_triangle(s)),
        ];
        (halves[0].union(halves[1]), TriangleBlock::of_corners(count, prims, [p, q, r, s]))
    }

    #[inline(always)]
    fn splits(&self) -> bool {
        true
    }

    #[inline]
    fn split(&self, prim: u32, bounds: Aabb, axis: usize, plane: f32) -> [Aabb; 2] {
        split_triangle(&self.corners(prim), bounds, axis, plane)
    }

    #[inline]
    fn visible(&self, prim: u32, bounds: Aabb) -> Option<Aabb> {
        visible(self, prim, bounds)
    }

    #[inline(always)]
    fn triangles(&self) -> Option<&Mesh> {
        Some(self)
    }

    #[inline(always)]
    fn prefetch(&self, prim: u32) {
        line(self.triangles(), prim as usize);
    }

    #[inline(always)]
    fn prefetch_first_corner(&self, prim: u32) {
        if let Some(triangle) = self.triangles().get(prim as usize) {
            line(self.padded_vertices(), triangle[0] as usize);
        }
    }

    #[inline(always)]
    fn prefetch_corners(&self, prim: u32) {
        if let Some(triangle) = self.triangles().get(prim as usize) {
            triangle.iter().for_each(|&vertex| line(self.padded_vertices(), vertex as usize));
        }
    }
}
