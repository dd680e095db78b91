//! The conventions of `phr::query`, for trees of both widths.

mod filtered;
mod tree;

use crate::trace_support::*;
use glam::Vec3;
use phr::geometry::{Mesh, Ray, Tracer};
use phr::query::Hit;
use phr::random::SplitMix64;
use phr::trace::verify::compare_closest;
use phr::trace::{BatchTracer, BruteForce, PathSettings, any_in_parallel, closest_in_parallel, record};
use phr::{Bvh, BvhConfig, geometry};
use std::f32::consts::SQRT_2;
use std::panic::{RefUnwindSafe, UnwindSafe};

/// Trees of both widths over `mesh`.
fn both(mesh: &Mesh) -> [Bvh; 2] {
    [median_tree::<4>(mesh, 4).try_into().unwrap(), median_tree::<8>(mesh, 4).try_into().unwrap()]
}

/// The triangle (0, 0, 0), (4, 0, 0), (0, 4, 0), and nine more at z = -10.
fn triangles() -> [Bvh; 2] {
    let mut vertices = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    vertices
        .extend((0..27).map(|i| [(i % 3 == 1) as u8 as f32 + i as f32, (i % 3 == 2) as u8 as f32, -10.0]));
    let prims = (0..10).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    both(&Mesh::new(vertices, prims).unwrap().0)
}

/// A ray from above onto (1, 2) of the triangle at z = 0, at t = 2.
const DOWN: Ray =
    Ray { org: Vec3::new(1.0, 2.0, 2.0), tnear: 0.0, dir: Vec3::new(0.0, 0.0, -1.0), tfar: f32::INFINITY };

#[test]
fn a_bvh_is_shared_among_threads() {
    const fn shared<T: Send + Sync + UnwindSafe + RefUnwindSafe + 'static>() {}
    const { shared::<Bvh>() }
}

#[test]
fn a_hit_has_its_coordinates_and_its_normal() {
    for bvh in triangles() {
        let hit = bvh.intersect(&DOWN).unwrap();
        assert_eq!((hit.prim, hit.normal), (0, Vec3::new(0.0, 0.0, 16.0)));
        assert!((hit.t - 2.0).abs() < 1e-6, "{hit:?}");
        assert!((hit.u - 0.25).abs() < 1e-6 && (hit.v - 0.5).abs() < 1e-6, "{hit:?}");
        assert!(bvh.occluded(&DOWN));
    }
}

#[test]
fn a_new_ray_has_no_end() {
    assert_eq!(Ray::new([1.0, 2.0, 2.0], Vec3::NEG_Z), DOWN);
}

#[test]
fn both_faces_are_hit_and_the_normal_is_not_turned() {
    let up = ray([1.0, 2.0, -3.0], [0.0, 0.0, 1.0]);
    for bvh in triangles() {
        let hit = bvh.intersect(&up).unwrap();
        assert!((hit.t - 3.0).abs() < 1e-6 && hit.normal.z == 16.0, "{hit:?}");
    }
}

#[test]
fn the_interval_excludes_its_start_and_includes_its_end() {
    let above = DOWN.tfar;
    let cases = [
        (0.0, 2.0, true),
        (0.0, 2f32.next_down(), false),
        (2.0, above, false),
        (2f32.next_down(), above, true),
        (2.0, 2.0, false),
        (3.0, 1.0, false),
        (0.0, 0.0, false),
        (0.0, -1.0, false),
        (0.0, f32::NEG_INFINITY, false),
        (0.0, f32::MAX, true),
    ];
    for bvh in triangles() {
        for (tnear, tfar, is_hit) in cases {
            // Away from the other triangles, which it would meet behind the first.
            let ray = Ray { org: Vec3::new(1.0, 2.5, 2.0), tnear, tfar, ..DOWN };
            assert_eq!(bvh.intersect(&ray).is_some(), is_hit, "{tnear} {tfar}");
            assert_eq!(bvh.occluded(&ray), is_hit, "{tnear} {tfar}");
        }
        let on_it = Ray { org: Vec3::new(1.0, 2.5, 0.0), ..DOWN };
        assert_eq!(bvh.intersect(&on_it), None, "t = 0 is not beyond tnear = 0");
    }
}

#[test]
fn distances_are_in_units_of_the_direction() {
    for bvh in triangles() {
        for length in [1e-15f32, 1e-3, 0.5, 3.0, 1e6, 1e15] {
            let hit = bvh.intersect(&Ray { dir: DOWN.dir * length, ..DOWN }).unwrap();
            assert!((hit.t * length - 2.0).abs() < 1e-5, "{length}: {hit:?}");
        }
    }
}

/// Slanted directions of either sign, with a component that is small beside the others, are hit alike at any length.
#[test]
fn lengths_of_slanted_directions_do_not_matter() {
    let mesh = soup(1000, 17);
    let mut random = SplitMix64::new(18);
    let rays: Vec<Ray> = (0..2000)
        .map(|_| {
            let mut dir = random.point(-1.0, 1.0);
            dir[random.below(3)] *= 1e-3;
            Ray { org: -1.5 * dir + 0.3 * random.point(-1.0, 1.0), tnear: 0.0, dir, tfar: f32::INFINITY }
        })
        .collect();
    for bvh in both(&mesh) {
        let found: Vec<_> = rays.iter().map(|ray| bvh.intersect(ray)).collect();
        assert!(found.iter().flatten().count() > 500);
        // Powers of two change no digit.
        for length in [2f32.powi(-33), 2f32.powi(33)] {
            for (ray, found) in rays.iter().zip(&found) {
                let hit = bvh.intersect(&Ray { dir: ray.dir * length, ..*ray });
                assert_eq!(hit.map(|hit| hit.prim), found.map(|hit| hit.prim), "{length}: {ray:?}");
            }
        }
    }
}

/// Where the products of the test leave the range of `f32` there may be no hit, but never a wrong distance.
#[test]
fn no_hit_has_a_distance_that_is_none() {
    let large = vec![[0.0, 0.0, 0.0], [1e10, 0.0, 0.0], [0.0, 1e10, 0.0]];
    let large = both(&Mesh::new(large, vec![[0, 1, 2]]).unwrap().0);
    let above = Ray { org: Vec3::new(1e9, 1e9, 2e9), ..DOWN };
    let mut hits = 0;
    // From within the boxes, where short directions count as those of 1e-18.
    let up = Ray { org: Vec3::new(0.5, 0.5, -1.0), dir: Vec3::Z, ..DOWN };
    let small = triangles();
    let of_small = small.iter().flat_map(|bvh| [(bvh, DOWN, 2.0), (bvh, up, 1.0)]);
    for (bvh, down, height) in of_small.chain(large.iter().map(|bvh| (bvh, above, 2e9))) {
        for length in [1e-44f32, 1e-42, 1e-40, 1e-39, 1e-38, 1e-37, 1e-30, 1e12, 1e17, 1e18, 1.8e18] {
            let ray = Ray { dir: down.dir * length, ..down };
            let mut batch = [None; 40];
            bvh.intersect_batch(&[ray; 40], &mut batch);
            for hit in batch.into_iter().chain([bvh.intersect(&ray)]).flatten() {
                let reached = f64::from(hit.t) * f64::from(length);
                assert!((reached / height - 1.0).abs() < 1e-3, "{length:e}: {hit:?}");
                hits += 1;
            }
        }
    }
    assert!(hits > 600, "most lengths are no trouble: {hits}");
}

#[test]
fn components_may_be_zero_or_denormal() {
    for bvh in triangles() {
        for small in [0.0, -0.0, f32::from_bits(1), -f32::MIN_POSITIVE, 1e-30] {
            for dir in [[small, small, -1.0], [small, 0.0, -1.0], [-0.0, small, -1.0]] {
                assert_eq!(bvh.intersect(&ray(DOWN.org.into(), dir)).map(|hit| hit.prim), Some(0), "{dir:?}");
            }
            assert_eq!(bvh.intersect(&ray(DOWN.org.into(), [small.min(0.0), 0.0, 0.0])), None);
        }
        // In the triangle's plane: it has no side to hit.
        assert_eq!(bvh.intersect(&ray([-1.0, 1.0, 0.0], [1.0, 0.0, 0.0])), None);
    }
}

#[test]
fn edges_and_corners_belong_to_the_triangle() {
    for bvh in triangles() {
        for (x, y) in [(0.0, 0.0), (2.0, 2.0), (1.0, 3.0), (0.0, 1.0), (3.0, 0.0)] {
            assert!(bvh.intersect(&Ray { org: Vec3::new(x, y, 2.0), ..DOWN }).is_some(), "{x} {y}");
        }
    }
}

/// Rays that are not valid, each in one way.
fn invalid() -> Vec<Ray> {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX];
    let mut rays: Vec<Ray> = [-1.0, f32::NAN, f32::INFINITY].map(|tnear| Ray { tnear, ..DOWN }).into();
    rays.push(Ray { tfar: f32::NAN, ..DOWN });
    for axis in 0..3 {
        for value in bad {
            let (mut org, mut dir) = (DOWN, DOWN);
            org.org[axis] = value;
            dir.dir[axis] = value;
            rays.extend([org, dir]);
        }
    }
    rays
}

#[test]
fn invalid_rays_miss_and_leave_their_neighbours_alone() {
    for bvh in triangles() {
        for ray in invalid() {
            assert!(!ray.is_valid());
            assert_eq!((bvh.intersect(&ray), bvh.occluded(&ray)), (None, false), "{ray:?}");
        }
        let rays: Vec<Ray> = invalid().into_iter().flat_map(|ray| [DOWN, ray]).collect();
        let (mut hits, mut occluded) = (vec![None; rays.len()], vec![true; rays.len()]);
        bvh.intersect_batch(&rays, &mut hits);
        bvh.occluded_batch(&rays, &mut occluded);
        for (index, (hit, occluded)) in hits.iter().zip(occluded).enumerate() {
            assert_eq!((hit.is_some(), occluded), (index % 2 == 0, index % 2 == 0), "{:?}", rays[index]);
        }
    }
}

#[test]
fn no_ray_panics() {
    let mesh = soup(500, 3);
    let mut random = SplitMix64::new(9);
    let mut bits = || f32::from_bits(random.below(1 << 32) as u32);
    let mut any = || Ray {
        org: Vec3::new(bits(), bits(), bits()),
        tnear: bits(),
        dir: Vec3::new(bits(), bits(), bits()),
        tfar: bits(),
    };
    let rays: Vec<Ray> =
        (0..40_000).map(|_| any()).map(|ray| Ray { tnear: ray.tnear.abs(), ..ray }).collect();
    assert!(rays.iter().filter(|ray| ray.is_valid()).count() > 1000);
    // Where products of such numbers overflow, one query may well hit what another misses.
    for bvh in both(&mesh) {
        let (mut hits, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
        bvh.intersect_batch(&rays, &mut hits);
        bvh.occluded_batch(&rays, &mut occluded);
        for (ray, hit) in rays.iter().zip(hits) {
            let single = (bvh.intersect(ray), bvh.occluded(ray));
            assert!(ray.is_valid() || (single, hit) == ((None, false), None), "{ray:?}");
        }
    }
}

/// A batch's answers are those of its rays one by one, and any hit is where a closest hit is.
fn check_batch(bvh: &Bvh, rays: &[Ray]) -> Vec<Option<Hit>> {
    let (mut hits, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
    bvh.intersect_batch(rays, &mut hits);
    bvh.occluded_batch(rays, &mut occluded);
    for ((ray, hit), occluded) in rays.iter().zip(&hits).zip(occluded) {
        // Of several at the same distance any may be told; one and the same is told alike.
        let single = bvh.intersect(ray);
        assert_eq!(single.map(|hit| hit.t), hit.map(|hit| hit.t), "{ray:?}");
        if single.map(|hit| hit.prim) == hit.map(|hit| hit.prim) {
            assert_eq!(single, *hit, "{ray:?}");
        }
        assert_eq!((bvh.occluded(ray), occluded), (hit.is_some(), hit.is_some()), "{ray:?}");
    }
    hits
}

/// Hits as tracers tell them.
fn plain(hits: &[Option<Hit>]) -> Vec<geometry::Hit> {
    hits.iter().map(|hit| hit.map_or(geometry::Hit::MISS, geometry::Hit::from)).collect()
}

#[test]
fn a_bvh_is_a_tracer() {
    let scene = phr::scene::scalable(3000, 1);
    let rays = rays(&scene.mesh, 3000, 2);
    let settings = PathSettings { width: 16, height: 16, max_depth: 3, seed: 3 };
    let record = |tracer: &dyn Tracer| record(tracer, &scene.mesh, &scene.views[0], &settings).batches;
    for width in [4, 8] {
        let bvh = Bvh::build(&scene.mesh, &BvhConfig::new("phr-speed", width)).unwrap();
        let (mut hits, mut occluded) = (vec![geometry::Hit::MISS; rays.len()], vec![false; rays.len()]);
        closest_in_parallel(&bvh, &rays, &mut hits);
        any_in_parallel(&bvh, &rays, &mut occluded);
        assert!(hits.iter().zip(&occluded).all(|(hit, occluded)| hit.is_hit() == *occluded));
        let reference = closest(&BruteForce(&scene.mesh), &rays);
        assert!(compare_closest(&scene.mesh, &rays, &reference, &hits).is_ok());
        let recorded = record(&bvh);
        let expected = match width {
            4 => record(&BatchTracer::new(bvh.as_bvh4().unwrap())),
            _ => record(&BatchTracer::new(bvh.as_bvh8().unwrap())),
        };
        assert!(recorded == expected && recorded.primary.len() == 16 * 16);
    }
}

#[test]
fn batches_hit_what_brute_force_hits() {
    for scale in [1e-6, 1.0, 1e6] {
        let still = soup(2000, 5);
        let vertices = still.vertices().iter().map(|v| v.map(|x| scale * x)).collect();
        let mesh = Mesh::new(vertices, still.triangles().to_vec()).unwrap().0;
        let scaled = |ray: &Ray| Ray { org: ray.org * scale, dir: ray.dir * scale, ..*ray };
        let rays: Vec<Ray> = rays(&still, 5001, 6).iter().map(scaled).collect();
        let reference = closest(&BruteForce(&mesh), &rays);
        for bvh in both(&mesh) {
            for rays in [&rays[..0], &rays[..1], &rays[..17]] {
                check_batch(&bvh, rays);
            }
            let hits = plain(&check_batch(&bvh, &rays));
            let verdict = compare_closest(&mesh, &rays, &reference, &hits);
            assert!(verdict.is_ok() && verdict.edge < 25, "{scale}: {verdict}");
        }
    }
}

#[test]
fn nothing_is_hit_in_an_empty_mesh() {
    let bvh = Bvh::build(&Mesh::new(vec![], vec![]).unwrap().0, &BvhConfig::default()).unwrap();
    assert_eq!((bvh.intersect(&DOWN), bvh.occluded(&DOWN)), (None, false));
    check_batch(&bvh, &[DOWN; 100]);
}

#[test]
fn normals_are_those_of_the_triangles() {
    let mesh = soup(200, 8);
    for bvh in both(&mesh) {
        for hit in rays(&mesh, 2000, 9).iter().filter_map(|ray| bvh.intersect(ray)) {
            let [a, b, c] = mesh.corners(hit.prim).map(Vec3::from);
            let normal = (b - a).cross(c - a);
            assert!((hit.normal - normal).length() <= 1e-4 * normal.length().max(SQRT_2 * f32::MIN_POSITIVE));
        }
    }
}
