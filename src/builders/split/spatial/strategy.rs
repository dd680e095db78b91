//! Which way finds the spatial split of a cut: by its length and the instruction set.

use super::bins::SpatialBins;
use super::lanes;
use super::plane_sweep::{PlaneSweep, SpatialCut};
use super::split::SpatialSplit;
use crate::builders::binary::node::Node;
use crate::builders::split::cost::Weight;
use crate::builders::split::object::bins::Bins;
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
    /// [`PlaneSweep::improve`] defines it. Object bins of the nodes, where there are any, spare a look at some planes.
    pub fn find(
        &mut self,
        isa: Isa,
        limit: f32,
        (nodes, bounds): (&[Node], Aabb),
        weight: Weight,
        of_object: Option<&Bins>,
    ) -> SpatialSplit {
        let boxes = SpatialCut { nodes, bounds, weight };
        let mut best = SpatialSplit { cost: limit, ..SpatialSplit::NONE };
        match isa {
            Isa::Avx512(token) => self.by_lanes(token, boxes, of_object, &mut best),
            Isa::Avx2(token) if nodes.len() <= lanes::MOST_AVX2 => {
                self.by_lanes(token, boxes, of_object, &mut best);
            }
            _ if nodes.len() <= SHORT => self.planes.improve(boxes, &mut best),
            _ => isa.run(
                #[inline(always)]
                || self.by_bins(boxes, of_object, &mut best),
            ),
        }
        if best.cost < limit { best } else { SpatialSplit::NONE }
    }

    fn by_lanes<L: Lanes>(
        &mut self,
        v: L,
        boxes: SpatialCut<'_>,
        of_object: Option<&Bins>,
        best: &mut SpatialSplit,
    ) {
        for axis in 0..3 {
            let Some(range) = planes(axis, boxes, of_object, best.cost) else { continue };
            if let Some(range) = lanes::search(v, axis, range, boxes, &mut self.lanes, best) {
                self.planes.improve_between(axis, boxes, range, best);
            }
        }
    }

    #[inline(always)]
    fn by_bins(&mut self, boxes: SpatialCut<'_>, of_object: Option<&Bins>, best: &mut SpatialSplit) {
        for axis in 0..3 {
            if let Some(range) = planes(axis, boxes, of_object, best.cost) {
                self.bins.improve_between(axis, boxes, range, &mut self.planes, best);
            }
        }
    }
}

/// Bounds of the planes normal to `axis`, the second exclusive, that are worth a look if they must cost less than
/// `limit`; `None` if no plane is.
#[inline]
fn planes(axis: usize, boxes: SpatialCut<'_>, of_object: Option<&Bins>, limit: f32) -> Option<[f32; 2]> {
    let [first, last] = [boxes.bounds.min[axis], boxes.bounds.max[axis]];
    let [from, to] = match of_object {
        Some(bins) => bins.planes_below(axis, limit, boxes.weight)?,
        None => [first, last],
    };
    let range = [from.max(first), to.min(last)];
    (range[0] < range[1]).then_some(range)
}
