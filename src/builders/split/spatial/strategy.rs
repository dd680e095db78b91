//! Which way finds the spatial split of a cut: by its length and the instruction set.

use super::bins::SpatialBins;
use super::lanes;
use super::plane_sweep::{PlaneSweep, SpatialCut};
use super::split::SpatialSplit;
use crate::builders::binary::node::Node;
use crate::builders::split::cost::Weight;
use crate::builders::split::object::PlaneHint;
use crate::geometry::Aabb;
use crate::simd::Isa;
use crate::simd::vector::Lanes;

/// Without vectors, bins pay for cuts of more nodes than this.
const SHORT: usize = 8;

/// Memory of sweeps.
#[derive(Default)]
pub(crate) struct SpatialSweep {
    bins: SpatialBins,
    planes: PlaneSweep,
    lanes: Vec<f32>,
}

impl SpatialSweep {
    /// The spatial split of `nodes`, whose union is `bounds`, of least cost, if that is below `limit`, as
    /// [`PlaneSweep::improve`] defines it.
    pub fn find(
        &mut self,
        isa: Isa,
        limit: f32,
        (nodes, bounds): (&[Node], Aabb),
        weight: Weight,
        hint: PlaneHint<'_>,
    ) -> SpatialSplit {
        let boxes = SpatialCut { nodes, bounds, weight };
        let mut best = SpatialSplit { cost: limit, ..SpatialSplit::NONE };
        match isa {
            Isa::Avx512(token) => self.by_lanes(token, boxes, hint, &mut best),
            Isa::Avx2(token) if nodes.len() <= lanes::MOST_AVX2 => {
                self.by_lanes(token, boxes, hint, &mut best);
            }
            _ if nodes.len() <= SHORT => self.planes.improve(boxes, &mut best),
            _ => self.bins.improve(&mut self.planes, boxes, &mut best),
        }
        if best.cost < limit { best } else { SpatialSplit::NONE }
    }

    fn by_lanes<L: Lanes>(
        &mut self,
        v: L,
        boxes: SpatialCut<'_>,
        hint: PlaneHint<'_>,
        best: &mut SpatialSplit,
    ) {
        let bounds = boxes.bounds;
        for axis in 0..3 {
            let Some([from, to]) = hint.planes_below(axis, best.cost, boxes.weight) else { continue };
            let range = [from.max(bounds.min[axis]), to.min(bounds.max[axis])];
            if let Some(range) = lanes::search(v, axis, range, boxes, &mut self.lanes, best) {
                self.planes.improve_between(axis, boxes, range, best);
            }
        }
    }
}
