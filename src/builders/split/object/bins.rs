//! The object split of a long cut, exactly, without sorting all of it: bins bound from below what the splits
//! within them may cost, and only those that may hold the best are sorted and swept. It finds the very split of
//! the full sweep (paper 4.2, where 5.6 suggests binning in its place).

use crate::builders::binary::Node;
use crate::builders::split::cost::Weight;
use crate::builders::split::object::{ObjectSplit, center, sortable};
use crate::builders::split::spatial::bins::{above, below};
use crate::geometry::Aabb;
use glam::Vec3A;

/// Most bins along each axis.
const BINS: usize = 32;

/// Bins for `n` nodes: few nodes do not pay for many.
fn bins_for(n: usize) -> usize {
    match n {
        ..=20 => 8,
        21..=100 => 16,
        _ => BINS,
    }
}

/// The nodes whose centroids lie in one bin.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Aabb::EMPTY, count: 0 };

    fn union(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count }
    }

    /// The cost of a side that has at least these nodes and `more`.
    fn cost(&self, more: usize, weight: Weight) -> f32 {
        self.bounds.half_area() * weight.of(self.count as usize + more)
    }
}

/// Memory of binned sweeps.
pub(crate) struct Bins {
    /// `bins[axis][b]`: the nodes of bin b.
    bins: [[Bin; BINS]; 3],
    /// `before[axis][b]`: those of all bins below b.
    before: [[Bin; BINS]; 3],
    /// `after[axis][b]`: those of all bins above b.
    after: [[Bin; BINS]; 3],
    /// Twice the centroids' bounds.
    centers: Aabb,
    /// The bin of each node, by axis.
    bin_of: Vec<[u8; 3]>,
    /// Sort keys of the nodes of one bin: (centroid << 32 | position in the cut).
    order: Vec<u64>,
    right_areas: Vec<f32>,
}

impl Default for Bins {
    fn default() -> Self {
        let empty = [[Bin::EMPTY; BINS]; 3];
        Self {
            bins: empty,
            before: empty,
            after: empty,
            centers: Aabb::EMPTY,
            bin_of: Vec::new(),
            order: Vec::new(),
            right_areas: Vec::new(),
        }
    }
}

impl Bins {
    /// The split of `nodes` of least cost below `limit`, as [`crate::builders::split::object::Sweep::best`] has it.
    pub fn best(&mut self, nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
        let bins = bins_for(nodes.len());
        self.fill(nodes, bins);
        let mut best = ObjectSplit { cost: limit, ..ObjectSplit::NONE };
        // Between two bins a split's cost is known.
        let mut border = None;
        for axis in 0..3 {
            for b in 1..bins {
                let (left, right) = (&self.before[axis][b], &self.after[axis][b - 1]);
                if self.bins[axis][b - 1].count == 0 || left.count == 0 || right.count == 0 {
                    continue;
                }
                let cost = left.cost(0, weight) + right.cost(0, weight);
                let split = ObjectSplit { cost, axis, left: left.count as usize, last: 0 };
                if split.is_before(&best) {
                    best = split;
                    border = Some(b);
                }
            }
        }
        for axis in 0..3 {
            for b in 0..bins {
                // Both sides of a split within the bin hold at least one of its nodes.
                let bound = self.before[axis][b].cost(1, weight) + self.after[axis][b].cost(1, weight);
                if self.bins[axis][b].count >= 2
                    && bound <= best.cost
                    && self.sweep(axis, b, nodes, weight, &mut best)
                {
                    border = None;
                }
            }
        }
        if best.left == 0 {
            return ObjectSplit::NONE;
        }
        if let Some(b) = border {
            let axis = best.axis;
            let on_left = (0..nodes.len()).filter(|&i| usize::from(self.bin_of[i][axis]) < b);
            let last = on_left.max_by_key(|&i| (sortable(center(&nodes[i], axis)), i));
            best.last = last.expect("neither side is empty");
        }
        best
    }

    /// Bounds of the planes normal to `axis`, up to the second without it, at which a spatial split of the nodes looked
    /// at last may cost less than `limit`; `None` if it cannot anywhere.
    ///
    /// What has its centroid before a plane reaches left of it, and what has it behind reaches right. So the bins before
    /// that of a plane and those after it, cut where it may lie, bound its cost from below.
    pub fn planes_below(&self, axis: usize, limit: f32, weight: Weight) -> Option<[f32; 2]> {
        let bins = bins_for(self.bin_of.len());
        // The plane between two bins, less or more than what rounding may have moved a centroid by.
        let (first, extent) =
            (self.centers.min[axis] * 0.5, (self.centers.max[axis] - self.centers.min[axis]) * 0.5);
        let slack = extent * 1e-3 + first.abs().max(extent) * 1e-5;
        let border = |b: usize| first + extent * (b as f32 / (bins as f32 * 0.999));
        let may_hold = |b: &usize| {
            let left = below(self.before[axis][*b].bounds, axis, border(*b) - slack);
            let right = above(self.after[axis][*b].bounds, axis, border(*b + 1) + slack);
            let cost = |side: Aabb, of: &Bin| side.half_area() * weight.of(of.count.max(1) as usize);
            cost(left, &self.before[axis][*b]) + cost(right, &self.after[axis][*b]) < limit
        };
        let last = (0..bins).rev().find(may_hold)?;
        let first = (0..bins).find(may_hold)?;
        let from = if first == 0 { f32::NEG_INFINITY } else { border(first) - slack };
        let to = if last + 1 == bins { f32::INFINITY } else { border(last + 1) + slack };
        Some([from, to])
    }

    fn fill(&mut self, nodes: &[Node], bins: usize) {
        let centers: Aabb = nodes.iter().fold(Aabb::EMPTY, |all, node| all.grow(node.bounds().center2()));
        self.centers = centers;
        let extent = centers.extent();
        // A flat side has one bin. The factor keeps the last node within the last bin.
        let scale = Vec3A::splat(bins as f32 * 0.999) / extent;
        let scale = Vec3A::select(scale.cmplt(Vec3A::splat(f32::MAX)), scale, Vec3A::ZERO);
        self.bins.iter_mut().for_each(|of_axis| of_axis[..bins].fill(Bin::EMPTY));
        self.bin_of.clear();
        self.bin_of.extend(nodes.iter().map(|node| {
            let bounds = node.bounds();
            let place = (bounds.center2() - centers.min) * scale;
            let bin_of = place.to_array().map(|x| (x as u32).min(bins as u32 - 1) as u8);
            for (axis, &bin) in bin_of.iter().enumerate() {
                let bin = &mut self.bins[axis][usize::from(bin)];
                bin.bounds = bin.bounds.union(bounds);
                bin.count += 1;
            }
            bin_of
        }));
        for axis in 0..3 {
            let mut before = Bin::EMPTY;
            for b in 0..bins {
                self.before[axis][b] = before;
                before = before.union(self.bins[axis][b]);
            }
            let mut after = Bin::EMPTY;
            for b in (0..bins).rev() {
                self.after[axis][b] = after;
                after = after.union(self.bins[axis][b]);
            }
        }
    }

    /// Sweeps over the nodes of a bin; returns whether it holds a better split.
    fn sweep(
        &mut self,
        axis: usize,
        b: usize,
        nodes: &[Node],
        weight: Weight,
        best: &mut ObjectSplit,
    ) -> bool {
        let (before, after) = (self.before[axis][b], self.after[axis][b]);
        self.order.clear();
        for (i, bin_of) in self.bin_of.iter().enumerate() {
            if usize::from(bin_of[axis]) == b {
                self.order.push(u64::from(sortable(center(&nodes[i], axis))) << 32 | i as u64);
            }
        }
        self.order.sort_unstable();
        let n = self.order.len();
        let node_at = |i: usize| self.order[i] as u32 as usize;
        self.right_areas.resize(n, 0.0);
        let mut right = after.bounds;
        for i in (1..n).rev() {
            right = right.union(nodes[node_at(i)].bounds());
            self.right_areas[i] = right.half_area();
        }
        let mut left = before.bounds;
        let mut found = false;
        for i in 1..n {
            left = left.union(nodes[node_at(i - 1)].bounds());
            let on_left = before.count as usize + i;
            let cost = left.half_area() * weight.of(on_left)
                + self.right_areas[i] * weight.of(nodes.len() - on_left);
            let split = ObjectSplit { cost, axis, left: on_left, last: node_at(i - 1) };
            if split.is_before(best) {
                *best = split;
                found = true;
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::split::object::Sweep;
    use crate::builders::split::object::lanes::Isa;
    use crate::builders::split::spatial::{SpatialSweep, anywhere};

    #[test]
    fn bins_find_the_split_of_the_full_sweep() {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) as f32
        };
        for round in 0..300 {
            let grain = [1.0, 3000.0, 20_000.0, 65_536.0][round % 4];
            let nodes: Vec<Node> = (0..17 + round * 3)
                .map(|i| {
                    let mut point = |scale: f32| Vec3A::new(random(), random(), random()) * scale - 30_000.0;
                    let a = (point(1.0) / grain).floor() * grain;
                    let size = if round % 3 == 0 { 1.0 } else { 0.05 };
                    Node::leaf(Aabb::new(a, a + (point(size) + 30_000.0)), i, 1)
                })
                .collect();
            let bounds: Aabb = nodes.iter().map(Node::bounds).collect();
            for weight in [Weight::Nodes, Weight::Quartets] {
                let expected = Sweep::plain().best(Isa::Scalar, &nodes, bounds, weight);
                let limit = weight.limit(bounds.half_area(), nodes.len());
                let mut bins = Bins::default();
                assert_eq!(bins.best(&nodes, limit, weight), expected, "{} nodes", nodes.len());
                // And no plane that they exclude is cheaper.
                for isa in Isa::available() {
                    let limit = expected.cost.min(limit);
                    let planes = |axis, limit| bins.planes_below(axis, limit, weight);
                    let mut sweep = SpatialSweep::default();
                    let among = sweep.below(isa, limit, &nodes, bounds, weight, planes);
                    let split = sweep.below(isa, limit, &nodes, bounds, weight, anywhere);
                    assert_eq!(among, split, "{isa:?}, {} nodes", nodes.len());
                }
            }
        }
    }
}
