//! All ways find the object split of the full sweep, on one table of cuts.

use super::bins::Bins;
use super::full_sweep::FullSweep;
use super::lanes;
use super::ranks::{self, RankSweep};
use super::split::ObjectSplit;
use super::strategy::ObjectSweep;
use crate::builders::binary::node::Node;
use crate::builders::split::cost::Weight;
use crate::builders::testing::for_each_cut;
use crate::geometry::Aabb;
use crate::simd::Isa;
use glam::Vec3A;

#[test]
fn every_way_finds_the_split_of_the_full_sweep() {
    let (mut full, mut bins) = (FullSweep::default(), Bins::default());
    let (mut ranks, mut strategy) = (RankSweep::default(), ObjectSweep::default());
    for_each_cut(|nodes, bounds| {
        for weight in [Weight::Nodes, Weight::Blocks] {
            let n = nodes.len();
            let limit = weight.limit(bounds.half_area(), n);
            let expected = full.best(nodes, limit, weight);
            let check = |way: &str, split: ObjectSplit| assert_eq!(split, expected, "{way}, {n} nodes");
            if n > 2 {
                check("bins", bins.best(&mut FullSweep::default(), nodes, limit, weight));
            }
            for isa in Isa::available() {
                let name = isa.name();
                check(name, strategy.find(isa, nodes, bounds, weight).0);
                match isa {
                    Isa::Scalar => {}
                    Isa::Avx2(token) => {
                        if n <= lanes::MOST_AVX2 {
                            check("AVX2 lanes", lanes::avx2(token, nodes, limit, weight));
                        }
                        if n <= ranks::MOST {
                            check("AVX2 ranks", ranks.best(token, nodes, limit, weight));
                        }
                    }
                    Isa::Avx512(token) => {
                        if n <= lanes::MOST {
                            check("AVX-512 lanes", lanes::avx512(token, nodes, limit, weight));
                        }
                        if n <= ranks::MOST {
                            check("AVX-512 ranks", ranks.best(token, nodes, limit, weight));
                        }
                    }
                }
            }
        }
    });
}

fn cubes(places: &[[f32; 3]]) -> (Vec<Node>, Aabb) {
    let cube = |&p: &[f32; 3]| Aabb::new(Vec3A::from_array(p), Vec3A::from_array(p) + 1.0);
    let nodes: Vec<Node> = places.iter().map(|p| Node::leaf(cube(p), 0, 1)).collect();
    let bounds = nodes.iter().map(Node::bounds).collect();
    (nodes, bounds)
}

#[test]
fn two_clusters_are_separated_along_their_axis() {
    let (nodes, bounds) = cubes(&[[0., 9., 0.], [0., 0., 0.], [0., 10., 0.], [0., 1., 0.], [0., 2., 0.]]);
    let (split, _) = ObjectSweep::default().find(Isa::best(), &nodes, bounds, Weight::Nodes);
    // Left: three cubes in a row, half area 3 + 3 + 1 = 7; right: two, half area 2 + 2 + 1 = 5.
    assert_eq!(split, ObjectSplit { cost: 7.0 * 3.0 + 5.0 * 2.0, axis: 1, left: 3, last: 4 });
    let is_left = split.members(&nodes);
    let left: Vec<bool> = nodes.iter().enumerate().map(|(i, node)| is_left(i, node)).collect();
    assert_eq!(left, [false, true, false, true, true]);
}

#[test]
fn boxes_all_alike_gain_nothing() {
    for n in [2, 3, 1000] {
        let (nodes, bounds) = cubes(&vec![[0.3, 0.7, 0.1]; n]);
        let (split, _) = ObjectSweep::default().find(Isa::best(), &nodes, bounds, Weight::Nodes);
        assert_eq!(split, ObjectSplit::NONE);
    }
}
