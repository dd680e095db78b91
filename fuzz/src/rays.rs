//! Any rays against a tree: no panic, the same answers alone and in a batch, and those of brute force wherever products
//! of three lengths are well within single precision.

use phr::geometry::{Hit, Mesh, Ray, Tracer};
use phr::glam::Vec3;
use phr::trace::verify::compare_closest;
use phr::trace::{BruteForce, BvhTracer};
use phr::{Bvh, BvhConfig};
use std::sync::OnceLock;

struct Scene {
    mesh: Mesh,
    trees: [Bvh; 2],
}

static SCENE: OnceLock<Scene> = OnceLock::new();

fn scene() -> Scene {
    let mesh: Mesh = phr::scene::scalable(400, 1).mesh;
    let built = |width| Bvh::build(&mesh, &BvhConfig { width, ..BvhConfig::default() }).unwrap();
    Scene { trees: [built(4), built(8)], mesh }
}

/// Distances to boxes and to triangles are rounded each in its own way, to within this share of them.
const ROUNDING: f32 = 4.0 * f32::EPSILON;

/// Checks the answers to `rays`.
pub fn check(rays: Vec<Ray>) {
    let Scene { mesh, trees } = SCENE.get_or_init(scene);
    for bvh in trees {
        let mut hits = vec![None; rays.len()];
        bvh.intersect_batch(&rays, &mut hits);
        let mut occluded = vec![false; rays.len()];
        bvh.occluded_batch(&rays, &mut occluded);
        for (i, ray) in rays.iter().enumerate() {
            let alone = bvh.intersect(ray);
            // Of triangles at the same distance up to rounding any may be reported.
            match (alone, hits[i]) {
                (Some(a), Some(b)) if a.prim != b.prim => {
                    assert!((a.t - b.t).abs() <= ROUNDING * a.t, "{ray:?} {a:?} {b:?}")
                }
                (a, b) => assert_eq!(a.map(|hit| hit.t), b.map(|hit| hit.t), "{ray:?}"),
            }
            assert_eq!(bvh.occluded(ray), occluded[i], "{ray:?}");
            // Of shorter directions closest hits are missed where any hits are found.
            let is_short = ray.dir.abs().max_element() < 1e-10;
            assert!(alone.is_some() == occluded[i] || is_short && occluded[i], "{ray:?}");
            if let Some(hit) = alone {
                assert!(hit.t.is_finite() && hit.t > ray.tnear && hit.t <= ray.tfar, "{ray:?} {hit:?}");
            }
        }
    }
    let is_moderate = |v: Vec3| (1e-6..1e6).contains(&v.length());
    let moderate: Vec<Ray> = rays
        .into_iter()
        .filter(|ray| ray.is_valid() && is_moderate(ray.org) && is_moderate(ray.dir))
        .collect();
    let mut expected = vec![Hit::MISS; moderate.len()];
    BruteForce(mesh).closest(&moderate, &mut expected);
    let found = [
        trees[0].as_bvh4().map(|tree| traced(&BvhTracer::new(tree), &moderate)),
        trees[1].as_bvh8().map(|tree| traced(&BvhTracer::new(tree), &moderate)),
    ];
    for found in found {
        let verdict = compare_closest(mesh, &moderate, &expected, &found.expect("the width asked for"));
        assert!(verdict.is_ok(), "{verdict}");
    }
}

fn traced(tracer: &dyn Tracer, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = vec![Hit::MISS; rays.len()];
    tracer.closest(rays, &mut hits);
    hits
}
