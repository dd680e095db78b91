//! All ways find the spatial split that equation 3 defines, on one table of cuts.

use super::bins::SpatialBins;
use super::plane_sweep::{PlaneSweep, SpatialCut};
use super::split::SpatialSplit;
use super::strategy::SpatialSweep;
use crate::builders::binary::node::Node;
use crate::builders::naive::splits;
use crate::builders::split::cost::Weight;
use crate::builders::split::object::bins::Bins;
use crate::builders::split::object::full_sweep::FullSweep;
use crate::builders::testing::for_each_cut;
use crate::geometry::Aabb;
use crate::simd::Isa;

/// Equation 3 evaluated by its definition.
fn by_definition(nodes: &[Node], weight: Weight) -> SpatialSplit {
    let boxes: Vec<Aabb> = nodes.iter().map(Node::bounds).collect();
    let split =
        |(cost, plane): (f32, splits::Plane)| SpatialSplit { cost, axis: plane.axis, plane: plane.at };
    splits::spatial(&boxes, &vec![1; boxes.len()], weight).map_or(SpatialSplit::NONE, split)
}

#[test]
fn every_way_finds_the_split_of_the_definition() {
    let (mut sweep, mut planes) = (SpatialSweep::default(), PlaneSweep::default());
    let (mut bins, mut spatial_bins) = (Bins::default(), SpatialBins::default());
    for_each_cut(|nodes, bounds| {
        let n = nodes.len();
        for weight in [Weight::Nodes, Weight::Blocks] {
            let expected = by_definition(nodes, weight);
            let boxes = SpatialCut { nodes, bounds, weight };
            let whole = || SpatialSplit { cost: f32::INFINITY, ..SpatialSplit::NONE };
            let (mut swept, mut binned) = (whole(), whole());
            planes.improve(boxes, &mut swept);
            for axis in 0..3 {
                let range = [bounds.min[axis], bounds.max[axis]];
                spatial_bins.improve_between(axis, boxes, range, &mut planes, &mut binned);
            }
            assert_eq!((swept, binned), (expected, expected), "{n} nodes");
            // Object bins exclude no plane that is cheaper.
            let limit = weight.limit(bounds.half_area(), n);
            bins.best(&mut FullSweep::default(), nodes, limit, weight);
            for isa in Isa::available() {
                for share in [0.5, 0.999, 1.0, 1.001, 2.0] {
                    let limit = expected.cost * share;
                    let best = if expected.cost < limit { expected } else { SpatialSplit::NONE };
                    for hint in [None, Some(&bins)] {
                        let split = sweep.find(isa, limit, (nodes, bounds), weight, hint);
                        assert_eq!(split, best, "{isa}, {n} nodes, share {share}");
                    }
                }
            }
        }
    });
}

#[test]
fn one_box_has_no_plane() {
    let node = Node::leaf(Aabb::new(glam::Vec3A::ZERO, glam::Vec3A::ONE), 0, 1);
    let limit = f32::INFINITY;
    for isa in Isa::available() {
        let split = SpatialSweep::default().find(isa, limit, (&[node], node.bounds()), Weight::Nodes, None);
        assert_eq!(split, SpatialSplit::NONE);
    }
}
