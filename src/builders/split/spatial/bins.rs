//! The spatial split of a long cut: the boundaries of nodes are put into bins, which bound the cost of their planes
//! from below, and only bins that may hold a cheaper plane are swept.

use super::plane_sweep::{PlaneSweep, SpatialCut};
use super::split::SpatialSplit;
use crate::builders::binary::node::Node;
use crate::builders::split::cost::{BINS, CountedBox, bins_for, step_scale};
use crate::geometry::Aabb;
use glam::Vec3A;

/// The node boundaries within one bin.
#[derive(Clone, Copy)]
struct Bin {
    /// Nodes that begin here.
    begin: CountedBox,
    /// Nodes that end here.
    end: CountedBox,
    /// The greatest boundary of nodes that begin, and the least of nodes that end.
    inner: [f32; 2],
}

impl Bin {
    const EMPTY: Self =
        Self { begin: CountedBox::EMPTY, end: CountedBox::EMPTY, inner: [f32::NEG_INFINITY, f32::INFINITY] };

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
    /// As [`PlaneSweep::improve`].
    pub fn improve(&mut self, planes: &mut PlaneSweep, boxes: SpatialCut<'_>, best: &mut SpatialSplit) {
        self.fill(boxes.nodes, boxes.bounds);
        for axis in 0..3 {
            self.improve_along(axis, planes, boxes, best);
        }
    }

    /// A plane within a bin has on its left all nodes that begin in bins before, and on its right all that end in bins
    /// after; their boxes, cut at the bin's outermost planes, and their numbers bound the cost from below.
    fn improve_along(
        &self,
        axis: usize,
        planes: &mut PlaneSweep,
        boxes: SpatialCut<'_>,
        best: &mut SpatialSplit,
    ) {
        let bins = &self.bins[axis];
        let [before, _] = CountedBox::before_and_after(&bins.map(|bin| bin.begin), self.used);
        let [_, after] = CountedBox::before_and_after(&bins.map(|bin| bin.end), self.used);
        // Both sides of a split hold a node.
        let cost = |side: Aabb, count: u32| side.half_area() * boxes.weight.of(count.max(1) as usize);
        for (b, (before, after)) in before.iter().zip(&after).enumerate().take(self.used) {
            let [first, last] = bins[b].planes(axis);
            let bound = cost(before.bounds.below(axis, first), before.count)
                + cost(after.bounds.above(axis, last), after.count);
            if first <= last && bound < best.cost {
                planes.improve_among(axis, boxes, self.members(axis, b as u8), [before, after], best);
            }
        }
    }

    /// Puts the boundaries of `nodes`, whose union is `bounds`, into bins.
    fn fill(&mut self, nodes: &[Node], bounds: Aabb) {
        self.used = bins_for(nodes.len());
        for of_axis in &mut self.bins {
            of_axis[..self.used].fill(Bin::EMPTY);
        }
        let scale = step_scale(bounds.extent(), self.used);
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

    /// The positions of the nodes that begin or end in a bin, with whether they do either.
    fn members(&self, axis: usize, bin: u8) -> impl Iterator<Item = (usize, [bool; 2])> {
        let places = self.places.iter().map(move |place| place.map(|at| at[axis] == bin)).enumerate();
        places.filter(|(_, [begins, ends])| begins | ends)
    }
}

/// Added to a float it leaves the nearest integer in the lowest bits.
const ROUND: f32 = (1 << 23) as f32;
