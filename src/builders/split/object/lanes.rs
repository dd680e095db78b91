//! The object split of a short cut without sorting: every lane of a vector is a candidate split, and every node
//! in turn joins the left or the right box of each. It finds the very split of [`crate::builders::split::object`].

#![allow(unsafe_code)]

use crate::builders::binary::Node;
use crate::builders::split::cost::Weight;
use crate::builders::split::lane_cost::{half_area, weigh};
use crate::builders::split::object::ObjectSplit;
use crate::simd::vector::Lanes;

/// The instruction set for short cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Isa {
    /// None: all cuts are sorted or binned.
    Scalar,
    /// Eight lanes.
    Avx2,
    /// Sixteen lanes.
    Avx512,
}

impl Isa {
    /// The best of this processor.
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if std::arch::is_x86_feature_detected!("avx512f")
                && std::arch::is_x86_feature_detected!("avx512vl")
            {
                return Self::Avx512;
            }
            if std::arch::is_x86_feature_detected!("avx2") {
                return Self::Avx2;
            }
        }
        Self::Scalar
    }

    /// Those of this processor.
    #[cfg(test)]
    pub fn available() -> impl Iterator<Item = Self> {
        let all = [Self::Scalar, Self::Avx2, Self::Avx512];
        all.into_iter().filter(|&isa| isa <= Self::best())
    }

    /// Nodes of the longest cut of which all splits are looked at without putting them in order.
    #[inline]
    pub fn longest(self) -> usize {
        match self {
            Self::Scalar => 0,
            Self::Avx2 | Self::Avx512 => 8,
        }
    }
}

impl Default for Isa {
    fn default() -> Self {
        Self::best()
    }
}

/// The split of 2 to [`Isa::longest`] nodes; see [`crate::builders::split::object::Sweep::best`].
#[inline]
pub(crate) fn best(isa: Isa, nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
    debug_assert!((2..=isa.longest()).contains(&nodes.len()));
    match isa {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `Isa::best` has found the feature.
        Isa::Avx512 => unsafe { x86::avx512(nodes, limit, weight) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `Isa::best` has found the feature.
        Isa::Avx2 => unsafe { x86::avx2(nodes, limit, weight) },
        _ => unreachable!("no cut is short enough"),
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::*;
    use crate::simd::vector::{Avx2, Avx512, Avx512Half};

    #[target_feature(enable = "avx512f,avx512vl")]
    pub(crate) unsafe fn avx512(nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
        match nodes.len() {
            ..=5 => sweep::<Avx512, 5>(nodes, limit, weight),
            _ => sweep::<Avx512Half, 8>(nodes, limit, weight),
        }
    }

    #[target_feature(enable = "avx2")]
    pub(crate) unsafe fn avx2(nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
        match nodes.len() {
            ..=2 => sweep::<Avx2, 2>(nodes, limit, weight),
            3..=4 => sweep::<Avx2, 4>(nodes, limit, weight),
            _ => sweep::<Avx2, 8>(nodes, limit, weight),
        }
    }
}

/// Sweeps with `SLOTS` lanes for each axis, as many axes at a time as a vector holds.
#[inline(always)]
fn sweep<L: Lanes, const SLOTS: usize>(nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
    let mut centers = [[0.0f32; 16]; 3];
    for (i, node) in nodes.iter().enumerate() {
        let [min, max] = node.corners();
        for axis in 0..3 {
            centers[axis][i] = min[axis] + max[axis];
        }
    }
    let at_once = (L::N / SLOTS).min(3);
    let mut best = ObjectSplit { cost: limit, ..ObjectSplit::NONE };
    let mut first = 0;
    while first < 3 {
        let axes = at_once.min(3 - first);
        pass::<L, SLOTS>(nodes, &centers, first, axes, weight, &mut best);
        first += axes;
    }
    if best.left == 0 { ObjectSplit::NONE } else { best }
}

/// Looks for a better split than `best` along the axes from `first` on.
#[inline(always)]
fn pass<L: Lanes, const SLOTS: usize>(
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
    let (own, position) = (L::load(&own), L::load(&position));
    let segment = L::load(&segment);
    let in_second = L::lt(L::splat(0.5), segment);
    let in_third = L::lt(L::splat(1.5), segment);
    let (inf, ninf) = (L::splat(f32::INFINITY), L::splat(f32::NEG_INFINITY));
    let (mut left_min, mut left_max) = ([inf; 3], [ninf; 3]);
    let (mut right_min, mut right_max) = ([inf; 3], [ninf; 3]);
    let mut count = L::splat(0.0);
    let one = L::splat(1.0);
    for (j, node) in nodes.iter().enumerate() {
        let mut center = L::splat(centers[first][j]);
        if axes > 1 {
            center = L::select(in_second, L::splat(centers[first + 1][j]), center);
        }
        if axes > 2 {
            center = L::select(in_third, L::splat(centers[first + 2][j]), center);
        }
        // Node j comes before node i in the order, or is node i.
        let before = L::lt(center, own);
        let level = L::and(L::le(center, own), L::le(L::splat(j as f32), position));
        let on_left = L::or(before, level);
        // Lanes without a split compare with NaN: all is on their right.
        let on_right = L::not(on_left);
        count = L::select(on_left, L::add(count, one), count);
        let [min, max] = node.corners();
        for axis in 0..3 {
            let (lower, upper) = (L::splat(min[axis]), L::splat(max[axis]));
            left_min[axis] = L::min_where(on_left, left_min[axis], lower);
            left_max[axis] = L::max_where(on_left, left_max[axis], upper);
            right_min[axis] = L::min_where(on_right, right_min[axis], lower);
            right_max[axis] = L::max_where(on_right, right_max[axis], upper);
        }
    }
    let zero = L::splat(0.0);
    let others = L::sub(L::splat(n as f32), count);
    let left = L::mul(half_area::<L>(left_min, left_max), weigh::<L>(weight, count));
    let right = L::mul(half_area::<L>(right_min, right_max), weigh::<L>(weight, others));
    // Nothing on the left or on the right is no split.
    let valid = L::and(L::lt(zero, count), L::lt(zero, others));
    let costs = L::select(valid, L::add(left, right), inf);
    let least = L::least(costs);
    if least < best.cost {
        let mut counts = [0.0f32; 16];
        L::store(count, &mut counts);
        let mut equal = L::bits(L::le(costs, L::splat(least)));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::split::object::Sweep;
    use crate::geometry::Aabb;
    use glam::Vec3A;

    #[test]
    fn every_instruction_set_finds_the_same_split() {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as f32
        };
        for round in 0..2000 {
            // Coarse grids have many equal centroids and costs, fine ones few.
            let grain = [1.0, 16.0, 64.0, 0.01][round % 4];
            let n = 2 + round % 7;
            let nodes: Vec<Node> = (0..n)
                .map(|i| {
                    let mut point = || Vec3A::new(random(), random(), random()) - 100.0;
                    let (a, b) = ((point() / grain).floor() * grain, (point() / grain).floor() * grain);
                    Node::leaf(Aabb::new(a.min(b), a.max(b)), i, 1)
                })
                .collect();
            let bounds: Aabb = nodes.iter().map(Node::bounds).collect();
            for weight in [Weight::Nodes, Weight::Quartets] {
                let expected = Sweep::plain().best(Isa::Scalar, &nodes, bounds, weight);
                let limit = weight.limit(bounds.half_area(), n);
                for isa in Isa::available().filter(|isa| n <= isa.longest()) {
                    assert_eq!(super::best(isa, &nodes, limit, weight), expected, "{isa:?}, {n} nodes");
                }
            }
        }
    }
}
