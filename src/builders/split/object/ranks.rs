//! The object split of a cut of middling length: each node's rank in the order of centroids is counted, all nodes of
//! a vector against one node at a time, which puts them in order along an axis without a branch; the sweep then goes
//! along all three axes at once. It finds the very split of [`crate::builders::split::object`].

#![allow(unsafe_code)]

use crate::builders::binary::Node;
use crate::builders::split::cost::Weight;
use crate::builders::split::object::ObjectSplit;
use crate::builders::split::object::lanes::Isa;
use crate::builders::split::three_axes::{Costs, order_by_ranks, sweep_axes};
use crate::geometry::Aabb;
use crate::simd::vector::Lanes;
use glam::Vec3A;

/// Nodes of the longest cut.
pub(crate) const LONGEST: usize = 128;

/// Nodes of the longest cut that is split faster so than by bins: counting takes the square of the time.
#[inline]
pub(crate) fn longest(isa: Isa) -> usize {
    match isa {
        Isa::Scalar => 0,
        Isa::Avx2 => 80,
        Isa::Avx512 => LONGEST,
    }
}

/// Memory of sweeps.
pub(crate) struct RankSweep {
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
    /// The split of 2 to [`LONGEST`] nodes of least cost below `limit`; see [`crate::builders::split::object::Sweep::best`]. `isa`
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
        self.put_in_order::<crate::simd::vector::Avx512>(nodes);
        self.sweep(nodes.len(), limit, weight)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    unsafe fn best_avx2(&mut self, nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
        self.put_in_order::<crate::simd::vector::Avx2>(nodes);
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
        order_by_ranks::<L, LONGEST>(&self.centers[..n], &mut self.order);
    }

    #[inline(always)]
    fn sweep(&mut self, n: usize, limit: f32, weight: Weight) -> ObjectSplit {
        let order = self.order.each_ref().map(|order| &order[..n]);
        let Costs { least, left } =
            sweep_axes(&self.boxes, order, &mut self.areas, limit, |count| weight.of(count));
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
    use crate::builders::split::object::Sweep;

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
