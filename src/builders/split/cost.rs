//! What a side of a split costs (paper 4.2, equation 1; 4.4, equation 3): its half area times its weight. One side at a
//! time, and as many as a vector has lanes.

use crate::bvh::limits::BLOCK;
use crate::geometry::Aabb;
use crate::simd::vector::Lanes;
use glam::Vec3A;

/// How the nodes of a side are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum Weight {
    /// Every node of the cut counts one, as in equation 1.
    Nodes,
    /// Every block of four counts one: what leaves cost, where the nodes are single triangles.
    Blocks,
}

/// A split must cost less than this part of no split (`S n`) to count as a gain: among boxes all alike every
/// split costs `S n` but for rounding, and the first of them would peel off one node at a time.
pub(super) const GAIN: f32 = 1.0 - 1.0 / (1 << 20) as f32;

impl Weight {
    /// The weight of `n` nodes.
    #[inline]
    pub fn of(self, n: usize) -> f32 {
        match self {
            Self::Nodes => n as f32,
            Self::Blocks => n.div_ceil(BLOCK as usize) as f32,
        }
    }

    /// As [`Weight::of`], of the number in each lane.
    #[inline(always)]
    pub fn of_lanes<L: Lanes>(self, v: L, n: L::F) -> L::F {
        match self {
            Self::Nodes => n,
            Self::Blocks => v.floor(v.mul(v.add(n, v.splat(3.0)), v.splat(0.25))),
        }
    }

    /// Splits of `n` nodes in a box of half area `area` must cost less than this.
    #[inline]
    pub fn limit(self, area: f32, n: usize) -> f32 {
        match self {
            Self::Nodes => area * n as f32 * GAIN,
            // The best split of a few triangles is taken whatever it costs.
            Self::Blocks => f32::INFINITY,
        }
    }
}

/// Bounds of costs from below are lowered by this factor, as they are rounded otherwise than costs are.
const BELOW: f32 = 1.0 - 1.0 / (1 << 20) as f32;

/// A bound from below of the cost of two sides that have at least the given half areas and numbers of nodes, where
/// `others` more nodes must be on one side or the other.
#[inline]
pub(crate) fn least_cost(areas: [f32; 2], counts: [u32; 2], others: u32, weight: Weight) -> f32 {
    let of_side = |i: usize| areas[i] * weight.of(counts[i] as usize);
    let of_others = match weight {
        Weight::Nodes => areas[0].min(areas[1]) * others as f32,
        // They may fill up blocks.
        Weight::Blocks => 0.0,
    };
    (of_side(0) + of_side(1) + of_others) * BELOW
}

/// [`Aabb::half_area`] of the box in each lane.
#[inline(always)]
pub(crate) fn half_areas<L: Lanes>(v: L, min: [L::F; 3], max: [L::F; 3]) -> L::F {
    let edge = |axis: usize| v.max(v.sub(max[axis], min[axis]), v.splat(0.0));
    let (x, y, z) = (edge(0), edge(1), edge(2));
    v.add(v.mul(x, v.add(y, z)), v.mul(y, z))
}

/// Some nodes of a cut: their union and their number.
#[derive(Clone, Copy)]
pub(crate) struct CountedBox {
    /// Their union.
    pub bounds: Aabb,
    /// Their number.
    pub count: u32,
}

impl CountedBox {
    /// No nodes.
    pub const EMPTY: Self = Self { bounds: Aabb::EMPTY, count: 0 };

    /// The nodes of both.
    #[inline]
    pub fn union(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count }
    }

    /// Adds a node.
    #[inline]
    pub fn add(&mut self, bounds: Aabb) {
        self.bounds = self.bounds.union(bounds);
        self.count += 1;
    }

    /// The cost of a side of these nodes.
    #[inline]
    pub fn cost(&self, weight: Weight) -> f32 {
        self.bounds.half_area() * weight.of(self.count as usize)
    }
}

/// Takes places within `extent` to cells along each axis: the last place is in the last cell, a flat side has one cell.
#[inline(always)]
pub(crate) fn cell_scale(extent: Vec3A, cells: usize) -> Vec3A {
    let scale = Vec3A::splat(cells as f32 * 0.999) / extent;
    Vec3A::select(scale.cmplt(Vec3A::splat(f32::MAX)), scale, Vec3A::ZERO)
}

/// Added to a float from 0 to 255 it leaves the nearest integer in the lowest bits. Conversions would check for more.
pub(super) const WHOLE: f32 = (1 << (f32::MANTISSA_DIGITS - 1)) as f32;

/// Most bins along an axis.
pub(crate) const BINS: usize = 32;

/// Bins for `n` nodes: few nodes do not pay for many.
pub(crate) fn bins_for(n: usize) -> usize {
    match n {
        ..=24 => BINS / 4,
        25..=96 => BINS / 2,
        _ => BINS,
    }
}
