//! Sweeps along all three axes at once, over boxes with indices of one byte.

use crate::geometry::Aabb;
use crate::geometry::ordered::ordered_bits;
use crate::simd::Isa;
use crate::simd::vector::Lanes;
use arrayvec::ArrayVec;
use glam::{Mat3A, Vec3A};

/// The cheapest splits along each axis.
pub(crate) struct AxisCosts {
    /// Their costs.
    pub least: Vec3A,
    /// Numbers of boxes on the left; 0 where no split is cheap enough.
    pub left: Vec3A,
}

/// The splits of least cost below `limit` of boxes in order along each axis (paper 4.2, equation 1), of equal ones the
/// first; `areas` is memory.
#[inline(always)]
pub(crate) fn sweep_axes<const MOST: usize>(
    boxes: &[Aabb; MOST],
    [x, y, z]: [&[u8]; 3],
    areas: &mut [Vec3A; MOST],
    limit: f32,
    weight: impl Fn(usize) -> f32,
) -> AxisCosts {
    let n = x.len();
    let (y, z) = (&y[..n], &z[..n]);
    let grow = |sides: &mut [Aabb; 3], i: usize| {
        for (side, order) in sides.iter_mut().zip([x, y, z]) {
            *side = side.union(boxes[usize::from(order[i]) % MOST]);
        }
    };
    let areas = &mut areas[..n];
    let mut sides = [Aabb::EMPTY; 3];
    for i in (1..n).rev() {
        grow(&mut sides, i);
        areas[i] = half_areas(&sides);
    }
    let mut sides = [Aabb::EMPTY; 3];
    let mut costs = AxisCosts { least: Vec3A::splat(limit), left: Vec3A::ZERO };
    let mut on_left = Vec3A::ZERO;
    for (i, &area) in areas.iter().enumerate().skip(1) {
        grow(&mut sides, i - 1);
        on_left += Vec3A::ONE;
        let cost = half_areas(&sides) * weight(i) + area * weight(n - i);
        let is_less = cost.cmplt(costs.least);
        costs.least = cost.min(costs.least);
        costs.left = Vec3A::select(is_less, on_left, costs.left);
    }
    costs
}

/// Half areas of three boxes, as [`Aabb::half_area`].
#[inline(always)]
fn half_areas(boxes: &[Aabb; 3]) -> Vec3A {
    let [a, b, c] = boxes.map(Aabb::extent);
    let e = Mat3A::from_cols(a, b, c).transpose();
    e.x_axis * (e.y_axis + e.z_axis) + e.y_axis * e.z_axis
}

/// Orders boxes by centroid along each axis, equal ones in their given order.
#[inline]
pub(crate) fn order<const MOST: usize>(isa: Isa, centers: &[Vec3A], order: &mut [[u8; MOST]; 3]) {
    match isa {
        Isa::Avx512(token) => token.run(
            #[inline(always)]
            move || order_by_ranks(token, centers, order),
        ),
        Isa::Avx2(token) => token.run(
            #[inline(always)]
            move || order_by_ranks(token, centers, order),
        ),
        Isa::Scalar => {
            let mut keys = ArrayVec::<u64, MOST>::new();
            for (axis, order) in order.iter_mut().enumerate() {
                keys.clear();
                let key =
                    |(i, center): (usize, &Vec3A)| u64::from(ordered_bits(center[axis])) << 32 | i as u64;
                keys.extend(centers.iter().enumerate().map(key));
                keys.sort_unstable();
                order.iter_mut().zip(&keys).for_each(|(place, &key)| *place = key as u8);
            }
        }
    }
}

/// As [`order`]: the rank of each box is counted, all boxes of a vector against one at a time.
#[inline(always)]
pub(crate) fn order_by_ranks<L: Lanes, const MOST: usize>(
    v: L,
    centers: &[Vec3A],
    order: &mut [[u8; MOST]; 3],
) {
    let n = centers.len();
    let one = v.splat(1.0);
    let mut positions = [0.0; 16];
    positions.iter_mut().enumerate().for_each(|(i, position)| *position = i as f32);
    let positions = v.load(&positions);
    for first in (0..n).step_by(L::N) {
        let end = (first + L::N).min(n);
        // Not by `map`, which is not always inlined.
        let mut own = [v.splat(0.0); 3];
        for (axis, own) in own.iter_mut().enumerate() {
            let mut places = [0.0; 16];
            places.iter_mut().zip(&centers[first..end]).for_each(|(place, center)| *place = center[axis]);
            *own = v.load(&places);
        }
        let mut ranks = [v.splat(0.0); 3];
        let count = |rank: &mut L::F, is_before| *rank = v.count_where(is_before, *rank);
        // Of equal centroids the first comes first.
        for center in &centers[..first] {
            for (axis, rank) in ranks.iter_mut().enumerate() {
                count(rank, v.le(v.splat(center[axis]), own[axis]));
            }
        }
        let mut position = v.splat(0.0);
        for center in &centers[first..end] {
            let is_first = v.lt(position, positions);
            position = v.add(position, one);
            for (axis, rank) in ranks.iter_mut().enumerate() {
                let center = v.splat(center[axis]);
                let level = v.and(v.le(center, own[axis]), is_first);
                count(rank, v.or(v.lt(center, own[axis]), level));
            }
        }
        for center in &centers[end..] {
            for (axis, rank) in ranks.iter_mut().enumerate() {
                count(rank, v.lt(v.splat(center[axis]), own[axis]));
            }
        }
        for (order, rank) in order.iter_mut().zip(ranks) {
            let mut places = [0.0; 16];
            v.store(v.counted(rank), &mut places);
            for (i, place) in (first..end).zip(places) {
                order[place as i32 as usize % MOST] = i as u8;
            }
        }
    }
}
