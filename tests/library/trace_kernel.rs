//! Our kernel against brute force in double precision, in every width and instruction set.

use crate::trace_support::*;
use glam::Vec3;
use phr::bvh::WideBvh;
use phr::geometry::{Hit, Mesh, Ray, Tracer};
use phr::random::SplitMix64;
use phr::trace::verify::{compare_any, compare_closest, witness};
use phr::trace::{BatchTracer, BruteForce, BvhTracer, Isa};

/// Traces `rays` through trees of `N` children by every instruction set and compares with brute force.
/// At most `edge` rays per thousand may be left to rounding.
fn check<const N: usize>(mesh: &Mesh, rays: &[Ray], edge: usize) {
    let brute = BruteForce(mesh);
    let (reference, occluded) = (closest(&brute, rays), any(&brute, rays));
    for leaf in [1, 4, 11, 28] {
        let tree = median_tree::<N>(mesh, leaf);
        for isa in Isa::available() {
            let tracer = BvhTracer::with_isa(&tree, isa);
            assert_eq!(tracer.isa(), isa);
            let hits = closest(&tracer, rays);
            let verdict = compare_closest(mesh, rays, &reference, &hits);
            assert!(verdict.is_ok(), "{N} {isa} leaves of {leaf}: {verdict}");
            assert!(verdict.edge <= rays.len() * edge / 1000, "{N} {isa} leaves of {leaf}: {verdict}");
            let shadows = any(&tracer, rays);
            let verdict = compare_any(mesh, rays, &occluded, &shadows, witness(&[&brute, &tracer]));
            assert!(verdict.is_ok(), "{N} {isa} leaves of {leaf}, any hit: {verdict}");
            for (hit, shadow) in hits.iter().zip(&shadows) {
                assert_eq!(hit.is_hit(), *shadow, "closest and any hit disagree");
            }
            let counts = tracer.count_closest(rays);
            assert_eq!(counts.rays, rays.len() as u64);
            assert_eq!(counts.hits, hits.iter().filter(|hit| hit.is_hit()).count() as u64);
            assert!(counts.block_tests >= counts.hits);
            assert_eq!(tracer.count_any(rays).hits, counts.hits);
        }
    }
}

fn check_widths(mesh: &Mesh, rays: &[Ray], edge: usize) {
    check::<4>(mesh, rays, edge);
    check::<8>(mesh, rays, edge);
}

#[test]
fn random_soups() {
    for (n, seed) in [(1, 1), (5, 2), (100, 3), (2000, 4)] {
        let mesh = soup(n, seed);
        check_widths(&mesh, &rays(&mesh, 3000, seed + 10), 5);
    }
}

#[test]
fn axis_aligned_walls() {
    for n in [1, 3, 8, 16] {
        let mesh = walls(n);
        check_widths(&mesh, &rays(&mesh, 3000, n as u64), 20);
    }
}

#[test]
fn rays_from_surfaces() {
    // Whether the surface itself is hit is for rounding to decide, what lies behind is not.
    let mesh = soup(500, 7);
    let rays: Vec<Ray> = rays(&mesh, 6000, 8).into_iter().skip(3).step_by(6).collect();
    let rays: Vec<Ray> = rays.iter().map(|ray| Ray { tnear: 0.0, ..*ray }).collect();
    check_widths(&mesh, &rays, 900);
}

#[test]
fn walls_never_leak() {
    // From inside a closed box every ray hits, whichever box border or triangle edge it meets.
    let mesh = walls(16);
    let mut random = SplitMix64::new(5);
    let rays: Vec<Ray> = (0..20_000)
        .map(|i| {
            let grid = |x: f32| (x * 8.0).round() / 8.0;
            let org = 0.9 * random.point(-1.0, 1.0);
            let target = random.point(-1.0, 1.0);
            let dir = if i % 2 == 0 { target.map(grid) - org.map(grid) * 0.5 } else { target - org };
            let org = if i % 2 == 0 { org.map(grid) * 0.5 } else { org };
            Ray { org, tnear: 0.0, dir, tfar: f32::INFINITY }
        })
        .filter(|ray| ray.dir != Vec3::ZERO)
        .collect();
    let tree = median_tree::<4>(&mesh, 4);
    for isa in Isa::available() {
        let tracer = BvhTracer::with_isa(&tree, isa);
        let misses: Vec<usize> = closest(&tracer, &rays)
            .iter()
            .enumerate()
            .filter_map(|(i, hit)| (!hit.is_hit()).then_some(i))
            .collect();
        // Moeller and Trumbore's test is not watertight; neither is Embree's fast one. Interior rays must hit.
        for &i in &misses {
            let brute = closest(&BruteForce(&mesh), &rays[i..=i]);
            let verdict = compare_closest(&mesh, &rays[i..=i], &brute, &[Hit::MISS]);
            assert!(verdict.is_ok(), "{isa}: {verdict} for {:?}", rays[i]);
        }
        assert!(misses.len() <= rays.len() / 1000, "{isa}: {} leaks", misses.len());
    }
}

#[test]
fn far_away_and_large_scenes() {
    let small = soup(300, 8);
    for (scale, offset) in [(1e-6, 0.0), (1e6, 0.0), (1e11, 0.0), (1.0, 1000.0)] {
        let place = |v: &[f32; 3]| v.map(|x| x * scale + offset);
        let placed = mesh(small.vertices().iter().map(place).collect(), small.triangles().to_vec());
        let rays: Vec<Ray> = rays(&small, 1500, 9)
            .iter()
            .map(|ray| Ray { org: ray.org * scale + offset, dir: ray.dir * scale, ..*ray })
            .collect();
        check::<4>(&placed, &rays, 5);
        check::<8>(&placed, &rays, 5);
    }
}

#[test]
fn the_interval_is_open_at_its_start_and_closed_at_its_end() {
    let mesh = one_triangle();
    let tree = median_tree::<4>(&mesh, 4);
    let down = ray([0.25, 0.25, 2.0], [0.0, 0.0, -1.0]);
    for isa in Isa::available() {
        let tracer = BvhTracer::with_isa(&tree, isa);
        for (tnear, tfar, expected) in [
            (0.0, f32::INFINITY, true),
            (0.0, 2.0, true),
            (0.0, 2.0f32.next_down(), false),
            (2.0, 3.0, false),
            (2.0f32.next_down(), 3.0, true),
            (3.0, 1.0, false),
            (0.0, f32::NEG_INFINITY, false),
        ] {
            let ray = Ray { tnear, tfar, ..down };
            assert_eq!(closest(&tracer, &[ray])[0].is_hit(), expected, "{isa} {tnear}..{tfar}");
            assert_eq!(any(&tracer, &[ray])[0], expected, "{isa} {tnear}..{tfar}");
        }
        let on_surface = ray([0.25, 0.25, 0.0], [0.0, 0.0, -1.0]);
        assert!(!any(&tracer, &[on_surface])[0], "t = 0 is no hit");
    }
}

#[test]
fn hits_carry_barycentric_coordinates_from_both_sides() {
    let mesh = one_triangle();
    let tree = median_tree::<8>(&mesh, 4);
    for isa in Isa::available() {
        let tracer = BvhTracer::with_isa(&tree, isa);
        for (from, dir) in [(2.0, -1.0), (-4.0, 2.0)] {
            let hit = closest(&tracer, &[ray([0.25, 0.5, from], [0.0, 0.0, dir])])[0];
            assert_eq!(hit.prim, 0);
            for (found, expected) in [(hit.t, 2.0), (hit.u, 0.25), (hit.v, 0.5)] {
                assert!((found - expected).abs() < 1e-6, "{isa} {hit:?}");
            }
        }
        for corner in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [0.0, 0.5]] {
            let hit = closest(&tracer, &[ray([corner[0], corner[1], 1.0], [0.0, 0.0, -1.0])])[0];
            assert!(hit.is_hit() && hit.u <= 1.0 && hit.v <= 1.0, "{isa}: corners and edges count as hit");
        }
    }
}

#[test]
fn empty_trees_and_degenerate_triangles_are_missed() {
    let nothing = WideBvh::<4>::default();
    let flat = mesh(vec![[0.0; 3], [1.0, 0.0, 0.0]], vec![[0, 1, 1], [0, 0, 0], [0, 1, 0]]);
    let flat_tree = median_tree::<4>(&flat, 1);
    let rays = rays(&flat, 600, 3);
    for isa in Isa::available() {
        for tree in [&nothing, &flat_tree] {
            let tracer = BvhTracer::with_isa(tree, isa);
            assert!(closest(&tracer, &rays).iter().all(|hit| *hit == Hit::MISS));
            assert!(!any(&tracer, &rays).contains(&true));
        }
    }
}

/// Distances that are not measurable, or round to zero, in the block of a triangle that is hit.
#[test]
fn what_has_no_distance_hides_nothing() {
    let small =
        [1e-19, 1e-20, 1e-21, 1e-22].map(|s| ([[-s, -s, 0.0], [s, -s, 0.0], [0.0, s, 0.0]], 1.0, 1.0));
    let walls =
        [1e-45, 3e-45, 1e-40].map(|z| ([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]], z, 4.0));
    for (front, z, length) in small.into_iter().chain(walls) {
        let behind = [[-1.0, -1.0, -1.0], [1.0, -1.0, -1.0], [0.0, 1.0, -1.0]];
        let mesh = mesh([front, behind].concat(), vec![[0, 1, 2], [3, 4, 5]]);
        let tree = median_tree::<8>(&mesh, 4);
        let ray = ray([0.0, 0.0, z], [0.0, 0.0, -length]);
        for isa in Isa::available() {
            let [single, batch]: [&dyn Tracer; 2] =
                [&BvhTracer::with_isa(&tree, isa), &BatchTracer::with_isa(&tree, isa)];
            for (tracer, rays) in [(single, 1), (batch, 3), (batch, 64)] {
                let hits = closest(tracer, &vec![ray; rays]);
                assert!(
                    hits.iter().all(|hit| hit.is_hit() && hit.t > 0.0),
                    "{isa} {front:?} {rays}: {hits:?}"
                );
            }
        }
    }
}

#[test]
fn invalid_rays_are_harmless() {
    let mesh = soup(500, 6);
    let tree = median_tree::<8>(&mesh, 4);
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -0.0, f32::MIN_POSITIVE / 4.0, 1e30];
    let mut random = SplitMix64::new(1);
    let rays: Vec<Ray> = (0..5000)
        .map(|_| {
            let mut x = [0.0; 8].map(|_: f32| random.range(-1.0, 1.0));
            for _ in 0..3 {
                x[random.below(8)] = bad[random.below(bad.len())];
            }
            let (org, dir) = (Vec3::new(x[0], x[1], x[2]), Vec3::new(x[3], x[4], x[5]));
            Ray { org, tnear: x[6], dir, tfar: x[7] }
        })
        .collect();
    for isa in Isa::available() {
        let tracer = BvhTracer::with_isa(&tree, isa);
        for hit in closest(&tracer, &rays) {
            assert!(hit == Hit::MISS || (hit.prim as usize) < mesh.len());
        }
        any(&tracer, &rays);
    }
}

#[test]
#[should_panic(expected = "malformed tree: link to node 9 of 0")]
fn malformed_trees_are_refused() {
    let tree = WideBvh::<4> { root: phr::bvh::Link::inner(9), ..WideBvh::default() };
    assert!(BvhTracer::try_new(&tree).is_err_and(|flaw| flaw == "malformed tree: link to node 9 of 0"));
    let _ = BvhTracer::new(&tree);
}
