//! The spatial split of a cut without sorting: every lane of a vector is a plane, and every node in turn joins the
//! left or the right box of each, or both.
//!
//! Where there are more planes than lanes, lanes are first borders between slabs of planes: the nodes left of a
//! slab and right of it bound the cost of its planes from below, and only planes in slabs that may hold one cheaper
//! than the best so far are evaluated.

use super::plane_sweep::SpatialCut;
use super::split::SpatialSplit;
use crate::builders::split::cost::half_areas;
use crate::simd::vector::Lanes;

/// Nodes of the longest cut that eight lanes split faster than bins; sixteen always do.
pub(crate) const MOST_AVX2: usize = 64;

/// Searches along an axis, in a range of planes without its end, for a split cheaper than `best`; of equal ones the
/// first. Returns bounds of planes, the second exclusive, that are too many for lanes and not evaluated yet;
/// `planes` is memory.
#[inline]
pub(crate) fn search<L: Lanes>(
    v: L,
    axis: usize,
    range: [f32; 2],
    boxes: SpatialCut<'_>,
    planes: &mut Vec<f32>,
    best: &mut SpatialSplit,
) -> Option<[f32; 2]> {
    v.run(
        #[inline(always)]
        move || match axis {
            0 => along::<L, 0>(v, range, boxes, planes, best),
            1 => along::<L, 1>(v, range, boxes, planes, best),
            _ => along::<L, 2>(v, range, boxes, planes, best),
        },
    )
}

/// As [`search`].
#[inline(always)]
fn along<L: Lanes, const AXIS: usize>(
    v: L,
    [mut from, mut to]: [f32; 2],
    boxes: SpatialCut<'_>,
    planes: &mut Vec<f32>,
    best: &mut SpatialSplit,
) -> Option<[f32; 2]> {
    let nodes = boxes.nodes.len();
    // Planes from `from` up to `to`, without the latter, are not evaluated yet.
    let mut len = 2 * nodes;
    let is_whole = from <= boxes.bounds.min[AXIS] && to >= boxes.bounds.max[AXIS];
    if len <= L::N || !is_whole {
        gather::<AXIS>(boxes, from, to, planes);
        len = planes.len();
    }
    while len > L::N {
        [from, to] = narrow::<L, AXIS>(v, boxes, from, to, best.cost)?;
        gather::<AXIS>(boxes, from, to, planes);
        let before = std::mem::replace(&mut len, planes.len());
        // The time to evaluate them, in passes over all nodes.
        let by_lanes = len.div_ceil(L::N);
        let by_sorting = 1 + SORT * len / nodes;
        if by_lanes.min(by_sorting) <= 2 || 4 * len > 3 * before {
            if by_sorting < by_lanes {
                return Some([from, to]);
            }
            break;
        }
    }
    evaluate::<L, AXIS>(v, boxes, planes, best);
    None
}

/// To sort and sweep one plane takes as long as a pass over this many nodes.
const SORT: usize = 10;

/// Evaluates each of the planes.
#[inline(always)]
fn evaluate<L: Lanes, const AXIS: usize>(
    v: L,
    boxes: SpatialCut<'_>,
    planes: &[f32],
    best: &mut SpatialSplit,
) {
    let last = v.splat(boxes.bounds.max[AXIS]);
    let mut is_found = false;
    for planes in planes.chunks(L::N) {
        let mut lanes = [f32::INFINITY; 16];
        lanes[..planes.len()].copy_from_slice(planes);
        let plane = v.load(&lanes);
        let sides = sides::<L, AXIS, true>(v, boxes, plane);
        // There are no planes in the other lanes.
        let costs = v.add(sides.left, sides.right);
        let costs = v.select(v.lt(plane, last), costs, v.splat(f32::INFINITY));
        let least = v.least(costs);
        if least < best.cost || (is_found && least == best.cost) {
            let equal = v.bits(v.le(costs, v.splat(least)));
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
fn gather<const AXIS: usize>(boxes: SpatialCut<'_>, from: f32, to: f32, planes: &mut Vec<f32>) {
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

/// Divides the planes from `from` up to `to` in slabs; returns the bounds of those that may hold one cheaper than
/// `limit`.
#[inline(always)]
fn narrow<L: Lanes, const AXIS: usize>(
    v: L,
    boxes: SpatialCut<'_>,
    from: f32,
    to: f32,
    limit: f32,
) -> Option<[f32; 2]> {
    let step = (to - from) / (L::N - 1) as f32;
    let mut borders = [to; 16];
    for (i, border) in borders[..L::N - 1].iter_mut().enumerate() {
        *border = (from + step * i as f32).min(to);
    }
    let sides = sides::<L, AXIS, false>(v, boxes, v.load(&borders));
    // The right side of a slab is that of its upper border, which is the next lane.
    let next = |x: L::F| {
        let mut lanes = [0.0; 17];
        v.store(x, (&mut lanes[..16]).try_into().expect("sixteen lanes"));
        v.load(lanes[1..].try_into().expect("sixteen lanes"))
    };
    let least = v.add(sides.left, next(sides.right));
    // A slab holds planes where fewer nodes lie before it than before its end, or fewer behind that than behind it.
    let begins = v.lt(sides.on_left, next(sides.on_left));
    let ends = v.lt(next(sides.on_right), sides.on_right);
    let slabs = v.bits(v.and(v.lt(least, v.splat(limit)), v.or(begins, ends))) & ((1 << (L::N - 1)) - 1);
    let last = slabs.checked_ilog2()? as usize;
    Some([borders[slabs.trailing_zeros() as usize], borders[last + 1]])
}

/// The sides of the planes in lanes.
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

/// The sides of each plane, if `IS_PLANE`. Otherwise lanes are borders of slabs: the left side holds the nodes left of
/// every plane at or after the border, the right side those right of every plane before it.
#[inline(always)]
fn sides<L: Lanes, const AXIS: usize, const IS_PLANE: bool>(
    v: L,
    boxes: SpatialCut<'_>,
    plane: L::F,
) -> Sides<L> {
    let (inf, ninf) = (v.splat(f32::INFINITY), v.splat(f32::NEG_INFINITY));
    let (mut left_min, mut left_max) = ([inf; 3], [ninf; 3]);
    let (mut right_min, mut right_max) = ([inf; 3], [ninf; 3]);
    let (mut on_left, mut on_right) = (v.splat(0.0), v.splat(0.0));
    for node in boxes.nodes {
        let [min, max] = node.corners();
        let (lower, upper) = (v.splat(min[AXIS]), v.splat(max[AXIS]));
        let (mut begins, mut ends) = (v.lt(lower, plane), v.le(plane, upper));
        if IS_PLANE {
            // A node that lies in the plane is on the left.
            begins = v.or(begins, v.le(upper, plane));
            ends = v.lt(plane, upper);
        }
        on_left = v.count_where(begins, on_left);
        on_right = v.count_where(ends, on_right);
        left_max[AXIS] = v.max_where(begins, left_max[AXIS], upper);
        right_min[AXIS] = v.min_where(ends, right_min[AXIS], lower);
        for axis in 0..3 {
            // The node that begins first is on the left of all planes, the one that ends last on the right.
            if axis != AXIS {
                let (lower, upper) = (v.splat(min[axis]), v.splat(max[axis]));
                left_min[axis] = v.min_where(begins, left_min[axis], lower);
                left_max[axis] = v.max_where(begins, left_max[axis], upper);
                right_min[axis] = v.min_where(ends, right_min[axis], lower);
                right_max[axis] = v.max_where(ends, right_max[axis], upper);
            }
        }
    }
    let (on_left, on_right) = (v.counted(on_left), v.counted(on_right));
    left_min[AXIS] = v.splat(boxes.bounds.min[AXIS]);
    left_max[AXIS] = v.select(v.lt(plane, left_max[AXIS]), plane, left_max[AXIS]);
    right_min[AXIS] = v.max(plane, right_min[AXIS]);
    right_max[AXIS] = v.splat(boxes.bounds.max[AXIS]);
    let left = v.mul(half_areas(v, left_min, left_max), boxes.weight.of_lanes(v, on_left));
    let right = v.mul(half_areas(v, right_min, right_max), boxes.weight.of_lanes(v, on_right));
    Sides { left, right, on_left, on_right }
}
