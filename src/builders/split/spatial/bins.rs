//! The spatial split of a long cut: the boundaries of nodes along an axis are put into bins, which bound the cost of
//! their planes from below, and only bins that may hold a cheaper plane are swept.

use super::plane_sweep::{PlaneSweep, SpatialCut};
use super::split::SpatialSplit;
use crate::builders::binary::node::Node;
use crate::builders::split::cost::{BINS, CountedBox, WHOLE, bins_for, cell_scale, least_cost};
use crate::geometry::Aabb;
use crate::geometry::ordered::{greater, smaller};
use glam::Vec3A;

/// The node boundaries within one bin.
#[derive(Clone, Copy)]
struct Bin {
    /// Nodes that begin here.
    begin: CountedBox,
    /// Nodes that end here.
    end: CountedBox,
    /// The number of nodes that do both.
    within: u32,
    /// The greatest boundary of nodes that begin, and the least of nodes that end.
    inner: [f32; 2],
}

impl Bin {
    const EMPTY: Self = Self {
        begin: CountedBox::EMPTY,
        end: CountedBox::EMPTY,
        within: 0,
        inner: [f32::NEG_INFINITY, f32::INFINITY],
    };

    /// The least and the greatest boundary.
    #[inline]
    fn planes(&self, axis: usize) -> [f32; 2] {
        let (begin, end) = (self.begin.bounds.min[axis], self.end.bounds.max[axis]);
        [begin.min(self.inner[1]), end.max(self.inner[0])]
    }
}

/// Boundaries along an axis in bins.
pub(crate) struct SpatialBins {
    /// The first bin is what lies before the range of planes, the one after the last what lies behind it.
    bins: [Bin; BINS + 2],
    /// `after[b]`: the nodes that end behind bin b.
    after: [CountedBox; BINS + 2],
    /// The bins where each node begins and ends.
    places: Vec<[u8; 2]>,
}

impl Default for SpatialBins {
    fn default() -> Self {
        Self { bins: [Bin::EMPTY; BINS + 2], after: [CountedBox::EMPTY; BINS + 2], places: Vec::new() }
    }
}

impl SpatialBins {
    /// As [`PlaneSweep::improve_between`].
    ///
    /// A plane within a bin has on its left all nodes that begin in bins before, on its right all that end in bins
    /// after, and on either side those that begin and end in this one; their boxes, cut at the bin's outermost planes,
    /// and their numbers bound the cost from below.
    #[inline(always)]
    pub fn improve_between(
        &mut self,
        axis: usize,
        boxes: SpatialCut<'_>,
        range: [f32; 2],
        planes: &mut PlaneSweep,
        best: &mut SpatialSplit,
    ) {
        let used = bins_for(boxes.nodes.len());
        self.fill(axis, boxes.nodes, range, used);
        let Self { bins, after, places } = self;
        after[used] = bins[used + 1].end;
        for b in (1..used).rev() {
            after[b] = after[b + 1].union(bins[b + 1].end);
        }
        let mut before = bins[0].begin;
        for b in 1..=used {
            let [first, last] = bins[b].planes(axis);
            let sides = [before.bounds.below(axis, first), after[b].bounds.above(axis, last)];
            let counts = [before.count, after[b].count];
            let bound = least_cost(sides.map(Aabb::half_area), counts, bins[b].within, boxes.weight);
            if first <= last && bound < best.cost {
                planes.improve_among(axis, boxes, members(places, b as u8), [&before, &after[b]], best);
            }
            before = before.union(bins[b].begin);
        }
    }

    /// Puts the boundaries of `nodes` into `used` bins of equal size, and those outside the range into the bins beside
    /// them.
    #[inline(always)]
    fn fill(&mut self, axis: usize, nodes: &[Node], [from, to]: [f32; 2], used: usize) {
        self.bins[..used + 2].fill(Bin::EMPTY);
        let scale = cell_scale(Vec3A::splat(to - from), used).x;
        let behind = (used + 1) as f32;
        // Bins are monotone in the coordinate, whatever is rounded; planes in the range are in one from 1 to `used`.
        let bin_of = |x: f32| {
            let place = smaller(greater((x - from) * scale + 0.501, 0.0), behind);
            ((place + WHOLE).to_bits() % 256) as usize
        };
        self.places.resize(nodes.len(), [0; 2]);
        for (node, places) in nodes.iter().zip(&mut self.places) {
            let b = node.bounds();
            let (lower, upper) = (node.lower(axis), node.upper(axis));
            let (begin, end) = (bin_of(lower), bin_of(upper));
            *places = [begin as u8, end as u8];
            let bin = &mut self.bins[begin];
            bin.begin.add(b);
            bin.inner[0] = greater(bin.inner[0], lower);
            let bin = &mut self.bins[end];
            bin.end.add(b);
            bin.within += u32::from(begin == end);
            bin.inner[1] = smaller(bin.inner[1], upper);
        }
    }
}

/// The positions of the nodes that begin or end in a bin, with whether they do either.
fn members(places: &[[u8; 2]], bin: u8) -> impl Iterator<Item = (usize, [bool; 2])> {
    let places = places.iter().map(move |place| place.map(|at| at == bin)).enumerate();
    places.filter(|(_, [begins, ends])| begins | ends)
}
