//! The spatial split of a cut without sorting: every lane of a vector is a plane, and every node in turn joins the
//! left or the right box of each, or both. It finds the very split of the sweep of [`crate::builders::split::spatial`].
//!
//! Where there are more planes than lanes, lanes are first borders between slabs of planes: what lies left of a
//! slab and right of it bounds the cost of its planes from below, and only planes in slabs that may hold one cheaper
//! than the best so far are looked at.

#![allow(unsafe_code)]

use crate::builders::binary::Node;
use crate::builders::split::cost::Weight;
use crate::builders::split::lane_cost::{half_area, weigh};
use crate::builders::split::object::lanes::Isa;
use crate::builders::split::spatial::SpatialSplit;
use crate::geometry::Aabb;
use crate::simd::vector::Lanes;

/// A cut to be split.
#[derive(Clone, Copy)]
pub(crate) struct Boxes<'a> {
    /// Its nodes.
    pub nodes: &'a [Node],
    /// Their union.
    pub bounds: Aabb,
    /// How they count.
    pub weight: Weight,
}

/// Nodes of the longest cut that is split faster so than by bins.
#[inline]
pub(crate) fn longest(isa: Isa) -> usize {
    match isa {
        Isa::Scalar => 0,
        Isa::Avx2 => 64,
        Isa::Avx512 => usize::MAX,
    }
}

/// Looks along an axis, in a range of planes without its end, for a split cheaper than `best`; of equal ones the first.
/// Returns bounds of planes, up to the second without it, that are too many for lanes and yet to be looked at. `isa` is
/// not [`Isa::Scalar`], and the processor has it; `planes` is memory.
#[inline]
pub(crate) fn search(
    isa: Isa,
    axis: usize,
    range: [f32; 2],
    boxes: Boxes<'_>,
    planes: &mut Vec<f32>,
    best: &mut SpatialSplit,
) -> Option<[f32; 2]> {
    match isa {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `Isa::best` has found the feature.
        Isa::Avx512 => unsafe { x86::avx512(axis, range, boxes, planes, best) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `Isa::best` has found the feature.
        Isa::Avx2 => unsafe { x86::avx2(axis, range, boxes, planes, best) },
        _ => unreachable!("there are no lanes"),
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::*;
    use crate::simd::vector::{Avx2, Avx512};

    #[target_feature(enable = "avx512f")]
    pub(crate) unsafe fn avx512(
        axis: usize,
        range: [f32; 2],
        boxes: Boxes<'_>,
        planes: &mut Vec<f32>,
        best: &mut SpatialSplit,
    ) -> Option<[f32; 2]> {
        match axis {
            0 => along::<Avx512, 0>(range, boxes, planes, best),
            1 => along::<Avx512, 1>(range, boxes, planes, best),
            _ => along::<Avx512, 2>(range, boxes, planes, best),
        }
    }

    #[target_feature(enable = "avx2")]
    pub(crate) unsafe fn avx2(
        axis: usize,
        range: [f32; 2],
        boxes: Boxes<'_>,
        planes: &mut Vec<f32>,
        best: &mut SpatialSplit,
    ) -> Option<[f32; 2]> {
        match axis {
            0 => along::<Avx2, 0>(range, boxes, planes, best),
            1 => along::<Avx2, 1>(range, boxes, planes, best),
            _ => along::<Avx2, 2>(range, boxes, planes, best),
        }
    }
}

/// As [`search`].
#[inline(always)]
fn along<L: Lanes, const AXIS: usize>(
    [mut from, mut to]: [f32; 2],
    boxes: Boxes<'_>,
    planes: &mut Vec<f32>,
    best: &mut SpatialSplit,
) -> Option<[f32; 2]> {
    let nodes = boxes.nodes.len();
    // Planes from `from` up to `to`, without the latter, are yet to be looked at.
    let mut len = 2 * nodes;
    let is_whole = from <= boxes.bounds.min[AXIS] && to >= boxes.bounds.max[AXIS];
    if len <= L::N || !is_whole {
        gather::<AXIS>(boxes, from, to, planes);
        len = planes.len();
    }
    while len > L::N {
        [from, to] = narrow::<L, AXIS>(boxes, from, to, best.cost)?;
        gather::<AXIS>(boxes, from, to, planes);
        let before = std::mem::replace(&mut len, planes.len());
        // What it takes to look at them, in passes over all nodes.
        let by_lanes = len.div_ceil(L::N);
        let by_sorting = 1 + SORT * len / nodes;
        if by_lanes.min(by_sorting) <= 2 || 4 * len > 3 * before {
            if by_sorting < by_lanes {
                return Some([from, to]);
            }
            break;
        }
    }
    look::<L, AXIS>(boxes, planes, best);
    None
}

/// To sort and sweep a plane takes as long as a pass over so many nodes.
const SORT: usize = 10;

/// Looks at each of the planes.
#[inline(always)]
fn look<L: Lanes, const AXIS: usize>(boxes: Boxes<'_>, planes: &[f32], best: &mut SpatialSplit) {
    let last = L::splat(boxes.bounds.max[AXIS]);
    let mut is_found = false;
    for planes in planes.chunks(L::N) {
        let mut lanes = [f32::INFINITY; 16];
        lanes[..planes.len()].copy_from_slice(planes);
        let plane = L::load(&lanes);
        let sides = sides::<L, AXIS, true>(boxes, plane);
        // There are no planes in the other lanes.
        let costs = L::add(sides.left, sides.right);
        let costs = L::select(L::lt(plane, last), costs, L::splat(f32::INFINITY));
        let least = L::least(costs);
        if least < best.cost || (is_found && least == best.cost) {
            let equal = L::bits(L::le(costs, L::splat(least)));
            let equal = (0..planes.len()).filter(|lane| equal >> lane & 1 == 1);
            let plane = equal.map(|lane| planes[lane]).fold(f32::INFINITY, f32::min);
            if least < best.cost || plane < best.plane {
                *best = SpatialSplit { cost: least, axis: AXIS, plane };
                is_found = true;
            }
        }
    }
}

/// The planes inside the bounds from `from` up to `to`, without the latter.
#[inline(always)]
fn gather<const AXIS: usize>(boxes: Boxes<'_>, from: f32, to: f32, planes: &mut Vec<f32>) {
    let first = boxes.bounds.min[AXIS];
    planes.resize(2 * boxes.nodes.len(), 0.0);
    let mut len = 0;
    for node in boxes.nodes {
        for plane in node.corners().map(|corner| corner[AXIS]) {
            planes[len] = plane;
            len += usize::from((plane >= from) & (plane < to) & (plane > first));
        }
    }
    planes.truncate(len);
}

/// Parts the planes from `from` up to `to` in slabs; returns the bounds of those that may hold one cheaper than
/// `limit`.
#[inline(always)]
fn narrow<L: Lanes, const AXIS: usize>(boxes: Boxes<'_>, from: f32, to: f32, limit: f32) -> Option<[f32; 2]> {
    let step = (to - from) / (L::N - 1) as f32;
    let mut borders = [to; 16];
    for (i, border) in borders[..L::N - 1].iter_mut().enumerate() {
        *border = (from + step * i as f32).min(to);
    }
    let sides = sides::<L, AXIS, false>(boxes, L::load(&borders));
    // The right side of a slab is that of its upper border, which is the next lane.
    let next = |x: L::F| {
        let mut lanes = [0.0; 17];
        L::store(x, (&mut lanes[..16]).try_into().expect("sixteen lanes"));
        L::load(lanes[1..].try_into().expect("sixteen lanes"))
    };
    let least = L::add(sides.left, next(sides.right));
    // A slab holds planes where fewer nodes lie before it than before its end, or fewer behind that than behind it.
    let begins = L::lt(sides.on_left, next(sides.on_left));
    let ends = L::lt(next(sides.on_right), sides.on_right);
    let slabs = L::bits(L::and(L::lt(least, L::splat(limit)), L::or(begins, ends))) & ((1 << (L::N - 1)) - 1);
    let last = slabs.checked_ilog2()? as usize;
    Some([borders[slabs.trailing_zeros() as usize], borders[last + 1]])
}

/// What lies on both sides of the planes in lanes.
struct Sides<L: Lanes> {
    /// Cost of the left side.
    left: L::F,
    /// Cost of the right side.
    right: L::F,
    /// Nodes on the left.
    on_left: L::F,
    /// Nodes on the right.
    on_right: L::F,
}

/// The sides of each plane, if `IS_PLANE`. Else lanes are borders: on the left is what is left of every plane at
/// the border or behind it, and on the right what is right of every plane before it.
#[inline(always)]
fn sides<L: Lanes, const AXIS: usize, const IS_PLANE: bool>(boxes: Boxes<'_>, plane: L::F) -> Sides<L> {
    let (inf, ninf) = (L::splat(f32::INFINITY), L::splat(f32::NEG_INFINITY));
    let (mut left_min, mut left_max) = ([inf; 3], [ninf; 3]);
    let (mut right_min, mut right_max) = ([inf; 3], [ninf; 3]);
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let (mut on_left, mut on_right) = (zero, zero);
    for node in boxes.nodes {
        let [min, max] = node.corners();
        let (lower, upper) = (L::splat(min[AXIS]), L::splat(max[AXIS]));
        let (mut begins, mut ends) = (L::lt(lower, plane), L::le(plane, upper));
        if IS_PLANE {
            // A node that lies in the plane is on the left.
            begins = L::or(begins, L::le(upper, plane));
            ends = L::lt(plane, upper);
        }
        on_left = L::select(begins, L::add(on_left, one), on_left);
        on_right = L::select(ends, L::add(on_right, one), on_right);
        left_max[AXIS] = L::max_where(begins, left_max[AXIS], upper);
        right_min[AXIS] = L::min_where(ends, right_min[AXIS], lower);
        for axis in 0..3 {
            // The node that begins first is on the left of all planes, the one that ends last on the right.
            if axis != AXIS {
                let (lower, upper) = (L::splat(min[axis]), L::splat(max[axis]));
                left_min[axis] = L::min_where(begins, left_min[axis], lower);
                left_max[axis] = L::max_where(begins, left_max[axis], upper);
                right_min[axis] = L::min_where(ends, right_min[axis], lower);
                right_max[axis] = L::max_where(ends, right_max[axis], upper);
            }
        }
    }
    left_min[AXIS] = L::splat(boxes.bounds.min[AXIS]);
    left_max[AXIS] = L::select(L::lt(plane, left_max[AXIS]), plane, left_max[AXIS]);
    right_min[AXIS] = L::max(plane, right_min[AXIS]);
    right_max[AXIS] = L::splat(boxes.bounds.max[AXIS]);
    let left = L::mul(half_area::<L>(left_min, left_max), weigh::<L>(boxes.weight, on_left));
    let right = L::mul(half_area::<L>(right_min, right_max), weigh::<L>(boxes.weight, on_right));
    Sides { left, right, on_left, on_right }
}
