//! The object split of a long cut without sorting all of it: bins bound from below the cost of the splits within them,
//! and only bins that may hold the best split are sorted and swept (paper 5.6 suggests binning in place of the sweep).

use super::full_sweep::FullSweep;
use super::split::ObjectSplit;
use crate::builders::binary::node::Node;
use crate::builders::split::cost::{BINS, CountedBox, WHOLE, Weight, bins_for, cell_scale, least_cost};
use crate::geometry::Aabb;
use crate::geometry::ordered::ordered_bits;
use glam::Vec3A;

/// The nodes of a cut in bins, by centroid.
pub(crate) struct Bins {
    /// `bins[axis][b]`: the nodes of bin b.
    bins: [[CountedBox; BINS]; 3],
    /// `before[axis][b]`: those of all bins below b.
    before: [[CountedBox; BINS]; 3],
    /// `after[axis][b]`: those of all bins above b.
    after: [[CountedBox; BINS]; 3],
    /// Half areas of both.
    areas: [[[f32; 2]; BINS]; 3],
    /// Twice the centroids' bounds.
    centers: Aabb,
    /// The bin of each node, by axis.
    bin_of: Vec<[u8; 3]>,
}

impl Default for Bins {
    fn default() -> Self {
        let empty = [[CountedBox::EMPTY; BINS]; 3];
        let areas = [[[0.0; 2]; BINS]; 3];
        Self { bins: empty, before: empty, after: empty, areas, centers: Aabb::EMPTY, bin_of: Vec::new() }
    }
}

impl Bins {
    /// The split of `nodes` of least cost below `limit`, as [`FullSweep::best`] defines it.
    #[inline(always)]
    pub fn best(&mut self, full: &mut FullSweep, nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
        let bins = bins_for(nodes.len());
        self.fill(nodes, bins);
        let mut best = ObjectSplit::below(limit);
        // Between two bins a split's cost is known.
        let mut border = None;
        for axis in 0..3 {
            for b in 1..bins {
                let (left, right) = (&self.before[axis][b], &self.after[axis][b - 1]);
                if self.bins[axis][b - 1].count == 0 || left.count == 0 || right.count == 0 {
                    continue;
                }
                let cost = self.areas[axis][b][0] * weight.of(left.count as usize)
                    + self.areas[axis][b - 1][1] * weight.of(right.count as usize);
                let split = ObjectSplit { cost, axis, left: left.count as usize, last: 0 };
                if split.is_before(&best) {
                    best = split;
                    border = Some(b);
                }
            }
        }
        for axis in 0..3 {
            for b in 0..bins {
                let within = self.bins[axis][b].count;
                if within < 2 {
                    continue;
                }
                // Both sides of a split within the bin hold at least one of its nodes.
                let sides = [&self.before[axis][b], &self.after[axis][b]];
                let counts = sides.map(|side| side.count + 1);
                let bound = least_cost(self.areas[axis][b], counts, within - 2, weight);
                let members = self.bin_of.iter().enumerate().filter(|(_, bins)| usize::from(bins[axis]) == b);
                if bound <= best.cost
                    && full.sweep(nodes, axis, members.map(|(i, _)| i), sides, weight, &mut best)
                {
                    border = None;
                }
            }
        }
        if let Some(b) = border {
            let axis = best.axis;
            let on_left = (0..nodes.len()).filter(|&i| usize::from(self.bin_of[i][axis]) < b);
            let last = on_left.max_by_key(|&i| (ordered_bits(nodes[i].center2(axis)), i));
            best.last = last.expect("neither side is empty");
        }
        best.or_none()
    }

    /// Bounds of the planes normal to `axis`, the second exclusive, at which a spatial split of the nodes may cost less
    /// than `limit`; `None` if no plane can.
    ///
    /// A node whose centroid lies left of a plane overlaps the left side, and one whose centroid lies right of it the
    /// right side. So the bins before that of a plane and those after it, cut where the plane may lie, bound its cost
    /// from below.
    pub fn planes_below(&self, axis: usize, limit: f32, weight: Weight) -> Option<[f32; 2]> {
        let bins = bins_for(self.bin_of.len());
        // The plane between two bins, less or more than rounding may have moved a centroid.
        let (first, extent) =
            (self.centers.min[axis] * 0.5, (self.centers.max[axis] - self.centers.min[axis]) * 0.5);
        let slack = extent * 1e-3 + first.abs().max(extent) * 1e-5;
        let border = |b: usize| first + extent * (b as f32 / (bins as f32 * 0.999));
        let may_hold = |b: &usize| {
            let (before, after) = (&self.before[axis][*b], &self.after[axis][*b]);
            let left = before.bounds.below(axis, border(*b) - slack);
            let right = after.bounds.above(axis, border(*b + 1) + slack);
            let areas = [left.half_area(), right.half_area()];
            least_cost(areas, [before.count, after.count], self.bins[axis][*b].count, weight) < limit
        };
        let last = (0..bins).rev().find(may_hold)?;
        let first = (0..bins).find(may_hold)?;
        let from = if first == 0 { f32::NEG_INFINITY } else { border(first) - slack };
        let to = if last + 1 == bins { f32::INFINITY } else { border(last + 1) + slack };
        Some([from, to])
    }

    #[inline(always)]
    fn fill(&mut self, nodes: &[Node], bins: usize) {
        let centers: Aabb = nodes.iter().fold(Aabb::EMPTY, |all, node| all.grow(node.bounds().center2()));
        self.centers = centers;
        let scale = cell_scale(centers.extent(), bins);
        self.bins.iter_mut().for_each(|of_axis| of_axis[..bins].fill(CountedBox::EMPTY));
        self.bin_of.resize(nodes.len(), [0; 3]);
        for (node, bin_of) in nodes.iter().zip(&mut self.bin_of) {
            let bounds = node.bounds();
            // Bins are monotone in the centroid, whatever is rounded.
            let place = ((bounds.center2() - centers.min) * scale - 0.5).max(Vec3A::ZERO) + WHOLE;
            for (axis, (bin, place)) in bin_of.iter_mut().zip(place.to_array()).enumerate() {
                *bin = place.to_bits() as u8;
                self.bins[axis][usize::from(*bin) % BINS].add(bounds);
            }
        }
        for axis in 0..3 {
            self.measure_sides(axis, bins);
        }
    }

    /// What is before and after each bin.
    #[inline(always)]
    fn measure_sides(&mut self, axis: usize, bins: usize) {
        let areas = &mut self.areas[axis][..bins];
        let (mut left, mut right) = (CountedBox::EMPTY, CountedBox::EMPTY);
        for ((bin, before), areas) in self.bins[axis].iter().zip(&mut self.before[axis]).zip(&mut *areas) {
            *before = left;
            areas[0] = left.bounds.half_area();
            left = left.union(*bin);
        }
        for ((bin, after), areas) in self.bins[axis].iter().zip(&mut self.after[axis]).zip(areas).rev() {
            *after = right;
            areas[1] = right.bounds.half_area();
            right = right.union(*bin);
        }
    }
}
