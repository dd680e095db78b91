//! The object split of a cut of middling length: each node's rank in the order of centroids is counted, all nodes of
//! a vector against one node at a time, which puts them in order along an axis without a branch; the sweep then goes
//! along all three axes at once. It finds the very split of [`super::object_split`].

#![allow(unsafe_code)]

use super::binary::Node;
use super::lanes::Lanes;
use super::object_split::ObjectSplit;
use super::small_sweep::Isa;
use super::split_cost::Weight;
use super::subtree_sweep::half_areas;
use crate::geometry::Aabb;
use glam::Vec3A;

/// Nodes of the longest cut.
pub(super) const LONGEST: usize = 128;

/// Nodes of the longest cut that is split faster so than by bins: counting takes the square of the time.
#[inline]
pub(super) fn longest(isa: Isa) -> usize {
    match isa {
        Isa::Scalar => 0,
        Isa::Avx2 => 80,
        Isa::Avx512 => LONGEST,
    }
}

/// Memory of sweeps.
pub(super) struct RankSweep {
    boxes: [Aabb; LONGEST],
    /// Twice the centroids.
    centers: [Vec3A; LONGEST],
    /// Positions in the cut by rank along each axis.
    order: [[u8; LONGEST]; 3],
    /// Half areas of the boxes of what follows, by axis.
    areas: [Vec3A; LONGEST],
}

impl Default for RankSweep {
    fn default() -> Self {
        Self {
            boxes: [Aabb::EMPTY; LONGEST],
            centers: [Vec3A::ZERO; LONGEST],
            order: [[0; LONGEST]; 3],
            areas: [Vec3A::ZERO; LONGEST],
        }
    }
}

impl RankSweep {
    /// The split of 2 to [`LONGEST`] nodes of least cost below `limit`; see [`super::object_split::Sweep::best`]. `isa`
    /// is not [`Isa::Scalar`], and the processor has it.
    #[inline]
    pub fn best(&mut self, isa: Isa, nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
        match isa {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `Isa::best` has found the feature.
            Isa::Avx512 => unsafe { self.best_avx512(nodes, limit, weight) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `Isa::best` has found the feature.
            Isa::Avx2 => unsafe { self.best_avx2(nodes, limit, weight) },
            _ => unreachable!("there are no lanes"),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f")]
    unsafe fn best_avx512(&mut self, nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
        self.put_in_order::<super::lanes::Avx512>(nodes);
        self.sweep(nodes.len(), limit, weight)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    unsafe fn best_avx2(&mut self, nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
        self.put_in_order::<super::lanes::Avx2>(nodes);
        self.sweep(nodes.len(), limit, weight)
    }

    #[inline(always)]
    fn put_in_order<L: Lanes>(&mut self, nodes: &[Node]) {
        let n = nodes.len();
        for (i, node) in nodes.iter().enumerate() {
            let bounds = node.bounds();
            self.boxes[i] = bounds;
            self.centers[i] = bounds.center2();
        }
        let centers = &self.centers[..n];
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
            for (order, rank) in self.order.iter_mut().zip(ranks) {
                let mut places = [0.0; 16];
                L::store(rank, &mut places);
                for (i, place) in (first..end).zip(places) {
                    order[place as i32 as usize % LONGEST] = i as u8;
                }
            }
        }
    }

    #[inline(always)]
    fn sweep(&mut self, n: usize, limit: f32, weight: Weight) -> ObjectSplit {
        let [x, y, z] = &self.order;
        let boxes = &self.boxes;
        let grow = |sides: &mut [Aabb; 3], i: usize| {
            for (side, order) in sides.iter_mut().zip([x, y, z]) {
                *side = side.union(boxes[usize::from(order[i]) % LONGEST]);
            }
        };
        let areas = &mut self.areas[..n];
        let mut sides = [Aabb::EMPTY; 3];
        for (i, area) in areas.iter_mut().enumerate().skip(1).rev() {
            grow(&mut sides, i);
            *area = half_areas(&sides);
        }
        let mut sides = [Aabb::EMPTY; 3];
        let (mut least, mut left) = (Vec3A::splat(limit), Vec3A::ZERO);
        for (i, &area) in areas.iter().enumerate().skip(1) {
            grow(&mut sides, i - 1);
            let cost = half_areas(&sides) * weight.of(i) + area * weight.of(n - i);
            let is_less = cost.cmplt(least);
            least = Vec3A::select(is_less, cost, least);
            left = Vec3A::select(is_less, Vec3A::splat(i as f32), left);
        }
        let mut best = ObjectSplit::NONE;
        for axis in 0..3 {
            if left[axis] > 0.0 && least[axis] < best.cost {
                let left = left[axis] as usize;
                let last = usize::from(self.order[axis][left - 1]);
                best = ObjectSplit { cost: least[axis], axis, left, last };
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::object_split::Sweep;

    #[test]
    fn every_instruction_set_finds_the_split_of_the_full_sweep() {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as f32
        };
        let mut sweep = RankSweep::default();
        for round in 0..2000 {
            // Coarse grids have many equal centroids and costs, fine ones few; on the coarsest all are alike.
            let grain = [1.0, 16.0, 64.0, 0.01, 256.0][round % 5];
            let n = 2 + round % (LONGEST - 1);
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
                for isa in Isa::available().filter(|&isa| isa != Isa::Scalar) {
                    assert_eq!(sweep.best(isa, &nodes, limit, weight), expected, "{isa:?}, {n} nodes");
                }
            }
        }
    }
}
