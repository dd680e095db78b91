//! What a spatial split must cost at least: most nodes have none that beats their object split, and a look at
//! bins tells so without sorting.

use super::binary::Node;
use super::split_cost::Weight;
use crate::geometry::Aabb;
use glam::Vec3A;

/// Most bins along each axis.
const BINS: usize = 16;

/// The node boundaries within one bin.
#[derive(Clone, Copy)]
struct Bin {
    /// Least and greatest boundary: planes within the bin lie between.
    planes: [f32; 2],
    /// Nodes that begin here: their union and number.
    begin: (Aabb, u32),
    /// Nodes that end here.
    end: (Aabb, u32),
}

impl Bin {
    const EMPTY: Self =
        Self { planes: [f32::INFINITY, f32::NEG_INFINITY], begin: (Aabb::EMPTY, 0), end: (Aabb::EMPTY, 0) };

    fn add_plane(&mut self, plane: f32) {
        self.planes = [self.planes[0].min(plane), self.planes[1].max(plane)];
    }
}

/// By axis, whether some spatial split of `nodes`, whose union is `bounds`, may cost less than `limit`.
///
/// A plane within a bin has on its left all nodes that begin in bins before, and on its right all that end in
/// bins after; their boxes, cut at the bin's outermost planes, and their numbers bound the cost from below.
pub(super) fn may_gain(nodes: &[Node], bounds: Aabb, weight: Weight, limit: f32) -> [bool; 3] {
    // Few nodes do not pay for many bins.
    let used = if nodes.len() <= 48 { BINS / 2 } else { BINS };
    let scale = Vec3A::splat(used as f32 * 0.999) / bounds.extent();
    let scale = Vec3A::select(scale.cmplt(Vec3A::splat(f32::MAX)), scale, Vec3A::ZERO);
    let mut bins = [[Bin::EMPTY; BINS]; 3];
    let bin_of = |point: Vec3A| {
        // Boxes lie within the bounds; bins are monotone in the coordinate, whatever is rounded.
        ((point - bounds.min) * scale).to_array().map(|x| (x as usize).min(used - 1))
    };
    for node in nodes {
        let b = node.bounds();
        let (begin, end) = (bin_of(b.min), bin_of(b.max));
        for axis in 0..3 {
            let bin = &mut bins[axis][begin[axis]];
            bin.add_plane(b.min[axis]);
            bin.begin = (bin.begin.0.union(b), bin.begin.1 + 1);
            let bin = &mut bins[axis][end[axis]];
            bin.add_plane(b.max[axis]);
            bin.end = (bin.end.0.union(b), bin.end.1 + 1);
        }
    }
    [0, 1, 2].map(|axis| axis_may_gain(axis, &bins[axis][..used], weight, limit))
}

fn axis_may_gain(axis: usize, bins: &[Bin], weight: Weight, limit: f32) -> bool {
    let mut after = [(Aabb::EMPTY, 0u32); BINS];
    for b in (1..bins.len()).rev() {
        after[b - 1] = (after[b].0.union(bins[b].end.0), after[b].1 + bins[b].end.1);
    }
    let mut before = (Aabb::EMPTY, 0u32);
    bins.iter().zip(after).any(|(bin, after)| {
        let (mut left, mut right) = (before.0, after.0);
        left.max[axis] = left.max[axis].min(bin.planes[0]);
        right.min[axis] = right.min[axis].max(bin.planes[1]);
        // Both sides of a split hold a node.
        let cost = left.half_area() * weight.of(before.1.max(1) as usize)
            + right.half_area() * weight.of(after.1.max(1) as usize);
        before = (before.0.union(bin.begin.0), before.1 + bin.begin.1);
        bin.planes[0] <= bin.planes[1] && cost < limit
    })
}
