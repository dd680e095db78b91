//! The object split of a cut of middling length: the rank of each node in the order of centroids is counted, all
//! nodes of a vector against one node at a time, which orders the nodes along an axis without a branch; one sweep
//! then goes along all three axes.

use super::split::ObjectSplit;
use crate::builders::binary::node::Node;
use crate::builders::split::cost::Weight;
use crate::builders::split::three_axes::{AxisCosts, order_by_ranks, sweep_axes};
use crate::geometry::Aabb;
use crate::simd::vector::Lanes;
use glam::Vec3A;

/// Nodes of the longest cut.
pub(crate) const MOST: usize = 128;
/// Nodes of the longest cut that is split faster so than by bins with vectors of eight lanes: counting takes the square
/// of the time.
pub(crate) const MOST_AVX2: usize = 80;

/// Memory of sweeps.
pub(crate) struct RankSweep {
    boxes: [Aabb; MOST],
    /// Twice the centroids.
    centers: [Vec3A; MOST],
    /// Positions in the cut by rank along each axis.
    order: [[u8; MOST]; 3],
    /// Half areas of the right sides, by axis.
    areas: [Vec3A; MOST],
}

impl Default for RankSweep {
    fn default() -> Self {
        Self {
            boxes: [Aabb::EMPTY; MOST],
            centers: [Vec3A::ZERO; MOST],
            order: [[0; MOST]; 3],
            areas: [Vec3A::ZERO; MOST],
        }
    }
}

impl RankSweep {
    /// The split of 2 to [`MOST`] nodes of least cost below `limit`, as [`super::full_sweep`] defines it.
    #[inline]
    pub fn best<L: Lanes>(&mut self, v: L, nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
        v.run(
            #[inline(always)]
            move || {
                let n = nodes.len();
                for (i, node) in nodes.iter().enumerate() {
                    let bounds = node.bounds();
                    self.boxes[i] = bounds;
                    self.centers[i] = bounds.center2();
                }
                order_by_ranks(v, &self.centers[..n], &mut self.order);
                self.sweep(n, limit, weight)
            },
        )
    }

    #[inline(always)]
    fn sweep(&mut self, n: usize, limit: f32, weight: Weight) -> ObjectSplit {
        let order = self.order.each_ref().map(|order| &order[..n]);
        let AxisCosts { least, left } =
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
