//! What spatial splits must cost at least: the boundaries of nodes are put into bins, and only planes in the few
//! bins that may hold one cheaper than a limit are looked at one by one.

use crate::builders::binary::Node;
use crate::builders::split::cost::Weight;
use crate::geometry::Aabb;
use glam::{BVec3A, Vec3A};

/// Most bins along each axis.
pub(crate) const BINS: usize = 32;

/// Bins for `n` nodes: few nodes do not pay for many.
fn bins_for(n: usize) -> usize {
    match n {
        ..=24 => BINS / 4,
        25..=96 => BINS / 2,
        _ => BINS,
    }
}

/// Nodes that lie on one side of all planes of a bin.
#[derive(Clone, Copy)]
pub(crate) struct Side {
    /// Their union.
    pub bounds: Aabb,
    /// Their number.
    pub count: u32,
}

impl Side {
    /// Nothing.
    pub const EMPTY: Self = Self { bounds: Aabb::EMPTY, count: 0 };

    fn union(self, other: &Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count }
    }

    /// Takes one more.
    #[inline]
    pub fn add(&mut self, bounds: Aabb) {
        self.bounds = self.bounds.union(bounds);
        self.count += 1;
    }
}

/// The node boundaries within one bin.
#[derive(Clone, Copy)]
struct Bin {
    /// Nodes that begin here.
    begin: Side,
    /// Nodes that end here.
    end: Side,
    /// The greatest boundary of those that begin, and the least of those that end.
    inner: [f32; 2],
}

impl Bin {
    const EMPTY: Self =
        Self { begin: Side::EMPTY, end: Side::EMPTY, inner: [f32::NEG_INFINITY, f32::INFINITY] };

    /// The least and the greatest boundary.
    #[inline]
    fn planes(&self, axis: usize) -> [f32; 2] {
        let (begin, end) = (self.begin.bounds.min[axis], self.end.bounds.max[axis]);
        [begin.min(self.inner[1]), end.max(self.inner[0])]
    }
}

/// Boundaries in bins.
pub(crate) struct SpatialBins {
    bins: [[Bin; BINS]; 3],
    used: usize,
    /// The bins by axis where each node begins and ends.
    places: Vec<[[u8; 4]; 2]>,
}

impl Default for SpatialBins {
    fn default() -> Self {
        Self { bins: [[Bin::EMPTY; BINS]; 3], used: BINS, places: Vec::new() }
    }
}

impl SpatialBins {
    /// Takes the boundaries of `nodes`, whose union is `bounds`.
    pub fn fill(&mut self, nodes: &[Node], bounds: Aabb) {
        self.used = bins_for(nodes.len());
        for of_axis in &mut self.bins {
            of_axis[..self.used].fill(Bin::EMPTY);
        }
        let scale = Vec3A::splat(self.used as f32 * 0.999) / bounds.extent();
        // A flat side has one bin.
        let scale = Vec3A::select(scale.cmplt(Vec3A::splat(f32::MAX)), scale, Vec3A::ZERO);
        // Boxes lie within the bounds; bins are monotone in the coordinate, whatever is rounded.
        let bin_of = |point: Vec3A| {
            let place = ((point - bounds.min) * scale - 0.5).max(Vec3A::ZERO) + ROUND;
            [place.x, place.y, place.z, 0.0].map(|place| place.to_bits() as u8)
        };
        self.places.clear();
        self.places.extend(nodes.iter().map(|node| {
            let b = node.bounds();
            let places = [bin_of(b.min), bin_of(b.max)];
            for axis in 0..3 {
                let [begin, end] = places.map(|place| usize::from(place[axis]) % BINS);
                let bin = &mut self.bins[axis][begin];
                bin.begin.add(b);
                bin.inner[0] = bin.inner[0].max(b.min[axis]);
                let bin = &mut self.bins[axis][end];
                bin.end.add(b);
                bin.inner[1] = bin.inner[1].min(b.max[axis]);
            }
            places
        }));
    }

    /// Looks for planes normal to `axis` that may cost less than `limit`: gives `sweep` each bin that may hold
    /// some, in order, with the nodes that lie on the left and on the right of all its planes (or reach across
    /// them), and goes on with the limit it returns.
    ///
    /// A plane within a bin has on its left all nodes that begin in bins before, and on its right all that end in
    /// bins after; their boxes, cut at the bin's outermost planes, and their numbers bound the cost from below.
    pub fn each_below(
        &self,
        axis: usize,
        mut limit: f32,
        weight: Weight,
        mut sweep: impl FnMut(u8, [&Side; 2]) -> f32,
    ) {
        let bins = &self.bins[axis][..self.used];
        let mut after = [Side::EMPTY; BINS];
        for b in (1..bins.len()).rev() {
            after[b - 1] = after[b].union(&bins[b].end);
        }
        let mut before = Side::EMPTY;
        for (b, (bin, after)) in bins.iter().zip(&after).enumerate() {
            let planes = bin.planes(axis);
            // Both sides of a split hold a node.
            let cost = below(before.bounds, axis, planes[0]).half_area()
                * weight.of(before.count.max(1) as usize)
                + above(after.bounds, axis, planes[1]).half_area() * weight.of(after.count.max(1) as usize);
            if planes[0] <= planes[1] && cost < limit {
                limit = sweep(b as u8, [&before, after]);
            }
            before = before.union(&bin.begin);
        }
    }

    /// The positions of the nodes, each with whether it begins and whether it ends in a bin, if it does either.
    pub fn members(&self, axis: usize, bin: u8) -> impl Iterator<Item = (usize, [bool; 2])> {
        let places = self.places.iter().map(move |place| place.map(|at| at[axis] == bin)).enumerate();
        places.filter(|(_, [begins, ends])| begins | ends)
    }
}

/// The part of a box below `plane` along an axis. Vectors are never written in parts: what reads them would wait.
#[inline(always)]
pub(crate) fn below(mut bounds: Aabb, axis: usize, plane: f32) -> Aabb {
    bounds.max = bounds.max.min(Vec3A::select(along(axis), Vec3A::splat(plane), Vec3A::INFINITY));
    bounds
}

/// The part of a box above `plane` along an axis.
#[inline(always)]
pub(crate) fn above(mut bounds: Aabb, axis: usize, plane: f32) -> Aabb {
    bounds.min = bounds.min.max(Vec3A::select(along(axis), Vec3A::splat(plane), Vec3A::NEG_INFINITY));
    bounds
}

/// True for one axis.
#[inline(always)]
fn along(axis: usize) -> BVec3A {
    BVec3A::new(axis == 0, axis == 1, axis == 2)
}

/// Added to a float it leaves the nearest integer in the lowest bits.
const ROUND: f32 = (1 << 23) as f32;
