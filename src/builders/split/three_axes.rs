//! Sweeps along all three axes at once, over boxes that are numbered by bytes.

#![allow(unsafe_code)]

use crate::builders::split::object::lanes::Isa;
use crate::builders::split::object::sortable;
use crate::geometry::Aabb;
use crate::simd::vector::Lanes;
use arrayvec::ArrayVec;
use glam::{Mat3A, Vec3A};

/// The cheapest splits along each axis.
pub(crate) struct Costs {
    /// What they cost.
    pub least: Vec3A,
    /// How many boxes they have on the left; 0 where none is cheap enough.
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
) -> Costs {
    let n = x.len();
    let grow = |sides: &mut [Aabb; 3], i: usize| {
        for (side, order) in sides.iter_mut().zip([x, y, z]) {
            *side = side.union(boxes[usize::from(order[i]) % MOST]);
        }
    };
    let areas = &mut areas[..n];
    let mut sides = [Aabb::EMPTY; 3];
    for (i, area) in areas.iter_mut().enumerate().skip(1).rev() {
        grow(&mut sides, i);
        *area = half_areas(&sides);
    }
    let mut sides = [Aabb::EMPTY; 3];
    let mut costs = Costs { least: Vec3A::splat(limit), left: Vec3A::ZERO };
    for (i, &area) in areas.iter().enumerate().skip(1) {
        grow(&mut sides, i - 1);
        let cost = half_areas(&sides) * weight(i) + area * weight(n - i);
        let is_less = cost.cmplt(costs.least);
        costs.least = Vec3A::select(is_less, cost, costs.least);
        costs.left = Vec3A::select(is_less, Vec3A::splat(i as f32), costs.left);
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

/// Puts boxes in order of their centroids along each axis, of equal ones the first first.
#[inline]
pub(crate) fn order<const MOST: usize>(isa: Isa, centers: &[Vec3A], order: &mut [[u8; MOST]; 3]) {
    match isa {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `Isa::best` has found the feature.
        Isa::Avx512 => unsafe { x86::avx512(centers, order) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `Isa::best` has found the feature.
        Isa::Avx2 => unsafe { x86::avx2(centers, order) },
        _ => {
            let mut keys = ArrayVec::<u64, MOST>::new();
            for (axis, order) in order.iter_mut().enumerate() {
                keys.clear();
                let key = |(i, center): (usize, &Vec3A)| u64::from(sortable(center[axis])) << 32 | i as u64;
                keys.extend(centers.iter().enumerate().map(key));
                keys.sort_unstable();
                order.iter_mut().zip(&keys).for_each(|(place, &key)| *place = key as u8);
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::order_by_ranks;
    use crate::simd::vector::{Avx2, Avx512};
    use glam::Vec3A;

    #[target_feature(enable = "avx512f")]
    pub(crate) unsafe fn avx512<const MOST: usize>(centers: &[Vec3A], order: &mut [[u8; MOST]; 3]) {
        order_by_ranks::<Avx512, MOST>(centers, order);
    }

    #[target_feature(enable = "avx2")]
    pub(crate) unsafe fn avx2<const MOST: usize>(centers: &[Vec3A], order: &mut [[u8; MOST]; 3]) {
        order_by_ranks::<Avx2, MOST>(centers, order);
    }
}

/// As [`order`]: the rank of each box is counted, all boxes of a vector against one at a time.
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
#[inline(always)]
pub(crate) fn order_by_ranks<L: Lanes, const MOST: usize>(centers: &[Vec3A], order: &mut [[u8; MOST]; 3]) {
    let n = centers.len();
    let one = L::splat(1.0);
    let mut positions = [0.0; 16];
    positions.iter_mut().enumerate().for_each(|(i, position)| *position = i as f32);
    let positions = L::load(&positions);
    for first in (0..n).step_by(L::N) {
        let end = (first + L::N).min(n);
        let own = [0, 1, 2].map(|axis| {
            let mut own = [0.0; 16];
            own.iter_mut().zip(&centers[first..end]).for_each(|(own, center)| *own = center[axis]);
            L::load(&own)
        });
        let mut ranks = [L::splat(0.0); 3];
        let count = |rank: &mut L::F, is_before| *rank = L::select(is_before, L::add(*rank, one), *rank);
        // Of equal centroids the first comes first.
        for center in &centers[..first] {
            for (axis, rank) in ranks.iter_mut().enumerate() {
                count(rank, L::le(L::splat(center[axis]), own[axis]));
            }
        }
        let mut position = L::splat(0.0);
        for center in &centers[first..end] {
            let is_first = L::lt(position, positions);
            position = L::add(position, one);
            for (axis, rank) in ranks.iter_mut().enumerate() {
                let center = L::splat(center[axis]);
                let level = L::and(L::le(center, own[axis]), is_first);
                count(rank, L::or(L::lt(center, own[axis]), level));
            }
        }
        for center in &centers[end..] {
            for (axis, rank) in ranks.iter_mut().enumerate() {
                count(rank, L::lt(L::splat(center[axis]), own[axis]));
            }
        }
        for (order, rank) in order.iter_mut().zip(ranks) {
            let mut places = [0.0; 16];
            L::store(rank, &mut places);
            for (i, place) in (first..end).zip(places) {
                order[place as i32 as usize % MOST] = i as u8;
            }
        }
    }
}
