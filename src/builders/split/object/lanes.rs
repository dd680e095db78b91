//! The object split of a short cut without sorting: every lane of a vector is a candidate split, and every node in turn
//! joins the left or the right box of each.

use super::split::ObjectSplit;
use crate::builders::binary::node::Node;
use crate::builders::split::cost::{Weight, half_areas};
use crate::simd::vector::{Avx512Half, Lanes};
use crate::simd::{Avx2, Avx512};

/// Nodes of the longest cut with AVX-512.
pub(crate) const MOST: usize = 8;
/// The same with AVX2; those of more are split faster by ranks.
pub(crate) const MOST_AVX2: usize = 4;

/// The split of 2 to [`MOST`] nodes of least cost below `limit`, as [`super::full_sweep`] defines it.
#[inline]
pub(crate) fn avx512(token: Avx512, nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
    token.run(
        #[inline(always)]
        move || match nodes.len() {
            ..=5 => sweep::<_, 5>(token, nodes, limit, weight),
            _ => sweep::<_, 8>(Avx512Half(token), nodes, limit, weight),
        },
    )
}

/// As [`avx512`], of up to [`MOST_AVX2`] nodes.
#[inline]
pub(crate) fn avx2(token: Avx2, nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
    token.run(
        #[inline(always)]
        move || sweep::<_, MOST_AVX2>(token, nodes, limit, weight),
    )
}

/// Sweeps with `SLOTS` lanes for each axis, as many axes at a time as a vector holds.
#[inline(always)]
fn sweep<L: Lanes, const SLOTS: usize>(v: L, nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
    let mut centers = [[0.0f32; 16]; 3];
    for (i, node) in nodes.iter().enumerate() {
        let [min, max] = node.corners();
        for axis in 0..3 {
            centers[axis][i] = min[axis] + max[axis];
        }
    }
    let at_once = (L::N / SLOTS).min(3);
    let mut best = ObjectSplit::below(limit);
    let mut first = 0;
    while first < 3 {
        let axes = at_once.min(3 - first);
        pass::<L, SLOTS>(v, nodes, &centers, first, axes, weight, &mut best);
        first += axes;
    }
    best.or_none()
}

/// Looks for a better split than `best` along the axes from `first` on.
#[inline(always)]
fn pass<L: Lanes, const SLOTS: usize>(
    v: L,
    nodes: &[Node],
    centers: &[[f32; 16]; 3],
    first: usize,
    axes: usize,
    weight: Weight,
    best: &mut ObjectSplit,
) {
    let n = nodes.len();
    // Lane `k * SLOTS + i`: the split whose last node on the left is node i along axis `first + k`.
    let (mut own, mut position) = ([f32::NAN; 16], [0.0f32; 16]);
    let mut segment = [0.0f32; 16];
    for k in 0..axes {
        for i in 0..n {
            own[k * SLOTS + i] = centers[first + k][i];
        }
        for i in 0..SLOTS {
            position[k * SLOTS + i] = i as f32;
            segment[k * SLOTS + i] = k as f32;
        }
    }
    let (own, position) = (v.load(&own), v.load(&position));
    let segment = v.load(&segment);
    let in_second = v.lt(v.splat(0.5), segment);
    let in_third = v.lt(v.splat(1.5), segment);
    let (inf, ninf) = (v.splat(f32::INFINITY), v.splat(f32::NEG_INFINITY));
    let (mut left_min, mut left_max) = ([inf; 3], [ninf; 3]);
    let (mut right_min, mut right_max) = ([inf; 3], [ninf; 3]);
    let mut count = v.splat(0.0);
    for (j, node) in nodes.iter().enumerate() {
        let mut center = v.splat(centers[first][j]);
        if axes > 1 {
            center = v.select(in_second, v.splat(centers[first + 1][j]), center);
        }
        if axes > 2 {
            center = v.select(in_third, v.splat(centers[first + 2][j]), center);
        }
        // Node j comes before node i in the order, or is node i.
        let before = v.lt(center, own);
        let level = v.and(v.le(center, own), v.le(v.splat(j as f32), position));
        let on_left = v.or(before, level);
        // Lanes without a split compare with NaN: all is on their right.
        let on_right = v.not(on_left);
        count = v.count_where(on_left, count);
        let [min, max] = node.corners();
        for axis in 0..3 {
            let (lower, upper) = (v.splat(min[axis]), v.splat(max[axis]));
            left_min[axis] = v.min_where(on_left, left_min[axis], lower);
            left_max[axis] = v.max_where(on_left, left_max[axis], upper);
            right_min[axis] = v.min_where(on_right, right_min[axis], lower);
            right_max[axis] = v.max_where(on_right, right_max[axis], upper);
        }
    }
    let count = v.counted(count);
    let zero = v.splat(0.0);
    let others = v.sub(v.splat(n as f32), count);
    let left = v.mul(half_areas(v, left_min, left_max), weight.of_lanes(v, count));
    let right = v.mul(half_areas(v, right_min, right_max), weight.of_lanes(v, others));
    // Nothing on the left or on the right is no split.
    let valid = v.and(v.lt(zero, count), v.lt(zero, others));
    let costs = v.select(valid, v.add(left, right), inf);
    let least = v.least(costs);
    if least < best.cost {
        let mut counts = [0.0f32; 16];
        v.store(count, &mut counts);
        let mut equal = v.bits(v.le(costs, v.splat(least)));
        // Of equal costs the first by axis, then by position.
        let mut found = (usize::MAX, f32::INFINITY, 0);
        while equal != 0 {
            let lane = equal.trailing_zeros() as usize;
            equal &= equal - 1;
            let (axis, rank) = (lane / SLOTS, counts[lane]);
            if axis < found.0 || (axis == found.0 && rank < found.1) {
                found = (axis, rank, lane % SLOTS);
            }
        }
        *best = ObjectSplit { cost: least, axis: first + found.0, left: found.1 as usize, last: found.2 };
    }
}
