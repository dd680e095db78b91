//! Hits that the caller turns down.

use super::{DOWN, both, triangles};
use crate::trace_support::*;
use phr::geometry::{Hit, Mesh, Ray};
use phr::trace::verify::compare_closest;
use phr::trace::{BruteForce, Isa, ProvenTree};
use phr::{Bvh, BvhConfig, builders};

/// Keeps two of five triangles.
fn is_kept(prim: u32) -> bool {
    prim.wrapping_mul(0x9e37_79b9) >> 16 & 0xff < 102
}

/// The mesh of the kept triangles, and which they are.
fn kept(mesh: &Mesh) -> (Mesh, Vec<u32>) {
    let prims: Vec<u32> = (0..mesh.len() as u32).filter(|&prim| is_kept(prim)).collect();
    let triangles = prims.iter().map(|&prim| mesh.triangles()[prim as usize]).collect();
    (self::mesh(mesh.vertices().to_vec(), triangles), prims)
}

/// Trees answer as if what is turned down were not there, whatever the builder, the width and the instructions: also
/// where the same triangle is in several leaves.
#[test]
fn what_is_turned_down_is_not_there() {
    fn check<const N: usize>(soup: &Mesh, builder: &str, rays: &[Ray], rest: &Mesh, prims: &[u32]) -> usize {
        let tree = builders::by_name::<N>(builder).unwrap().build(soup).tree;
        let references = tree.blocks.iter().flat_map(|block| block.ids()).count();
        let tree = ProvenTree::new(tree).unwrap();
        let truth = closest(&BruteForce(rest), rays);
        for isa in Isa::available() {
            let mut turned_down = 0;
            let find = |ray: &Ray| {
                let mut hit = tree.closest_filtered(isa, ray, |hit| {
                    assert!(
                        hit.is_hit() && ray.tnear * 0.999 <= hit.t && hit.t <= ray.tfar * 1.001,
                        "{hit:?} {ray:?}"
                    );
                    turned_down += usize::from(!is_kept(hit.prim));
                    is_kept(hit.prim)
                });
                assert_eq!(hit.is_hit(), tree.any_filtered(isa, ray, |hit| is_kept(hit.prim)), "{ray:?}");
                if hit.is_hit() {
                    hit.prim = prims.binary_search(&hit.prim).unwrap() as u32;
                }
                hit
            };
            let found: Vec<Hit> = rays.iter().map(find).collect();
            let report = compare_closest(rest, rays, &truth, &found);
            assert!(report.is_ok(), "{builder}, {N}-wide, {isa}: {report:?}");
            assert!(turned_down > 500, "{isa}: {turned_down}");
        }
        references
    }
    let soup = soup(900, 3);
    let (rest, prims) = kept(&soup);
    assert!((200..500).contains(&prims.len()), "{}", prims.len());
    let rays = rays(&soup, 2000, 4);
    let mut most = 0;
    for builder in ["lbvh", "phr-hq", "phr-best"] {
        most = most.max(check::<4>(&soup, builder, &rays, &rest, &prims));
        most = most.max(check::<8>(&soup, builder, &rays, &rest, &prims));
    }
    assert!(most > soup.len(), "no triangle is in two leaves");
}

#[test]
fn a_filter_that_accepts_all_or_nothing() {
    let soup = soup(500, 5);
    let rays = rays(&soup, 500, 6);
    for width in [4, 8] {
        let bvh = Bvh::build(&soup, &BvhConfig { width, ..BvhConfig::default() }).unwrap();
        for ray in &rays {
            assert_eq!(bvh.intersect_filtered(ray, |_| true), bvh.intersect(ray), "{ray:?}");
            assert_eq!(bvh.occluded_filtered(ray, |_| true), bvh.occluded(ray), "{ray:?}");
            let mut asked = 0;
            let mut refuse = |_: &phr::query::Hit| {
                asked += 1;
                false
            };
            assert_eq!(bvh.intersect_filtered(ray, &mut refuse), None);
            assert!(!bvh.occluded_filtered(ray, &mut refuse));
            assert!(asked >= 2 * u32::from(bvh.occluded(ray)));
        }
    }
}

/// Four triangles of one block at the same place, each of which may be turned down; the closure may trace rays itself.
#[test]
fn each_triangle_of_a_block_is_asked_about() {
    let one = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    for bvh in both(&mesh(one.to_vec(), vec![[0, 1, 2]; 4])) {
        for wanted in 0..4 {
            let hit = bvh.intersect_filtered(&DOWN, |hit| hit.prim == wanted && bvh.occluded(&DOWN)).unwrap();
            assert_eq!((hit.prim, hit.normal.z), (wanted, 16.0));
            assert!(bvh.occluded_filtered(&DOWN, |hit| hit.prim == wanted));
        }
    }
    let invalid = Ray { tnear: -1.0, ..DOWN };
    for bvh in triangles() {
        assert_eq!(bvh.intersect_filtered(&invalid, |_| panic!("an invalid ray hits")), None);
        assert!(!bvh.occluded_filtered(&invalid, |_| panic!("an invalid ray hits")));
    }
}

/// Layers at z = 0, -1, ... -9, each of its own leaf block or several to a leaf: the interval ends before, at and behind
/// those that are accepted.
#[test]
fn a_filter_keeps_to_the_interval() {
    let layer = |i: u32| {
        let z = -(i as f32);
        [[-9.0, -9.0, z], [27.0, -9.0, z], [-9.0, 27.0, z]]
    };
    let vertices = (0..10).flat_map(layer).collect();
    for bvh in both(&mesh(vertices, (0..10).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())) {
        for wanted in 0..10 {
            let accepts = |hit: &phr::query::Hit| hit.prim >= wanted;
            let at = 2.0 + wanted as f32;
            let until = |tfar| Ray { tfar, ..DOWN };
            let hit = bvh.intersect_filtered(&until(at + 0.5), accepts).unwrap();
            assert_eq!((hit.prim, hit.t), (wanted, at));
            assert!(bvh.occluded_filtered(&until(at + 0.5), accepts));
            assert_eq!(bvh.intersect_filtered(&until(at - 0.5), accepts), None);
            assert!(!bvh.occluded_filtered(&until(at - 0.5), accepts));
            let behind = Ray { tnear: at + 0.5, ..DOWN };
            let next = bvh.intersect_filtered(&behind, accepts).map(|hit| hit.prim);
            assert_eq!(next, Some(wanted + 1).filter(|&next| next < 10));
        }
    }
    for bvh in both(&mesh(Vec::new(), Vec::new())) {
        assert_eq!(bvh.intersect_filtered(&DOWN, |_| true), None);
        assert!(!bvh.occluded_filtered(&DOWN, |_| true));
    }
}

/// A closure that panics leaves the tree as it was.
#[test]
fn a_filter_may_panic() {
    for bvh in triangles() {
        let panics = || bvh.intersect_filtered(&DOWN, |_| panic!("of the caller's"));
        assert!(std::panic::catch_unwind(panics).is_err());
        assert_eq!(bvh.intersect_filtered(&DOWN, |_| true), bvh.intersect(&DOWN));
    }
}
