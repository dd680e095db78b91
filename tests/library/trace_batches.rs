//! Batches against single rays and brute force, in both widths and every instruction set.

use crate::trace_support::*;
use glam::Vec3;
use phr::geometry::{Hit, Mesh, Ray};
use phr::random::SplitMix64;
use phr::trace::verify::{compare_any, compare_closest, witness};
use phr::trace::{BatchTracer, BruteForce, BvhTracer, Isa};

/// Traces `rays` in batches by every instruction set; at most `edge` rays per thousand may be left to rounding.
fn check<const N: usize>(mesh: &Mesh, rays: &[Ray], edge: usize) {
    for leaf in [4, 11] {
        let tree = median_tree::<N>(mesh, leaf);
        let single = BvhTracer::new(&tree);
        let (reference, occluded) = (closest(&single, rays), any(&single, rays));
        for isa in Isa::available() {
            let batch = BatchTracer::with_isa(&tree, isa);
            assert_eq!(batch.isa(), isa);
            let verdict = compare_closest(mesh, rays, &reference, &closest(&batch, rays));
            assert!(
                verdict.is_ok() && verdict.edge <= rays.len() * edge / 1000,
                "{N} {isa} {leaf}: {verdict}"
            );
            let shadows = any(&batch, rays);
            let verdict = compare_any(mesh, rays, &occluded, &shadows, witness(&[&single, &batch]));
            assert!(
                verdict.is_ok() && verdict.edge <= rays.len() * edge / 1000,
                "{N} {isa} {leaf}: {verdict}"
            );
        }
    }
}

fn check_widths(mesh: &Mesh, rays: &[Ray], edge: usize) {
    check::<4>(mesh, rays, edge);
    check::<8>(mesh, rays, edge);
}

/// Rays from `org` over a square of directions, row by row.
fn camera(org: Vec3, side: i32) -> Vec<Ray> {
    let angle = |i: i32| (i as f32 + 0.5) / side as f32 - 0.5;
    let pixels = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
    pixels.map(|(x, y)| ray(org.into(), [angle(x), angle(y), -1.0])).collect()
}

#[test]
fn coherent_rays() {
    let mesh = soup(3000, 1);
    // From outside, from inside, and straight along an axis with zeros of either sign.
    check_widths(&mesh, &camera(Vec3::new(0.3, 0.2, 4.0), 70), 5);
    check_widths(&mesh, &camera(Vec3::ZERO, 70), 5);
    let mut random = SplitMix64::new(2);
    let zeros = [0.0, -0.0, f32::from_bits(1), -1e-30];
    let parallel: Vec<Ray> = (0..2000)
        .map(|i| {
            ray((random.point(-1.0, 1.0) + 3.0 * Vec3::Z).into(), [zeros[i % 4], zeros[i / 4 % 4], -2.0])
        })
        .collect();
    check_widths(&mesh, &parallel, 5);
}

/// Of a direction of denormal numbers the test's products leave the range: its distance is no number. The rays
/// beside it have theirs.
#[test]
fn a_ray_without_a_distance_harms_no_other() {
    let mesh = joined(&walls(4), &soup(2000, 11));
    let mut random = SplitMix64::new(12);
    let mut towards = |i: usize| {
        let org = random.point(-4.0, -1.5);
        let dir = random.point(-0.5, 0.9) - org;
        let scale = if i % 64 == 63 { [1e-41, 1e-40, 1e-39, 1e-20][i / 64 % 4] } else { 1.0 };
        ray(org.into(), (dir * scale).into())
    };
    let rays: Vec<Ray> = (0..4096).map(&mut towards).collect();
    check_widths(&mesh, &rays, 5);
}

#[test]
fn scattered_rays_of_all_sorts() {
    for (n, seed) in [(1, 1), (5, 2), (2000, 4)] {
        let mesh = soup(n, seed);
        check_widths(&mesh, &rays(&mesh, 4000, seed + 10), 5);
    }
    let walls = walls(8);
    check_widths(&walls, &rays(&walls, 4000, 5), 20);
}

#[test]
fn rays_at_walls_from_afar() {
    let mesh = joined(&walls(4), &soup(500, 3));
    let afar = |ray: &Ray| {
        let org = ray.org - 1e3 * ray.dir.normalize_or(Vec3::X);
        Ray { org, tnear: 0.0, tfar: f32::INFINITY, ..*ray }
    };
    let rays: Vec<Ray> = rays(&mesh, 4000, 6).iter().map(afar).collect();
    check_widths(&mesh, &rays, 50);
}

#[test]
fn hits_at_the_very_end_of_the_interval_are_found() {
    let mesh = walls(16);
    let mut random = SplitMix64::new(9);
    let scattered: Vec<Ray> = (0..4000)
        .map(|_| ray((0.9 * random.point(-1.0, 1.0)).into(), random.point(-1.0, 1.0).into()))
        .collect();
    at_the_end::<4>(&mesh, &scattered);
    at_the_end::<8>(&mesh, &scattered);
}

/// Holds the answers of batches to those of single rays that end where they hit.
fn at_the_end<const N: usize>(mesh: &Mesh, rays: &[Ray]) {
    let tree = median_tree::<N>(mesh, 4);
    for isa in Isa::available() {
        let (single, batch) = (BvhTracer::with_isa(&tree, isa), BatchTracer::with_isa(&tree, isa));
        let hits = closest(&single, rays);
        let ending: Vec<Ray> = rays.iter().zip(&hits).map(|(ray, hit)| Ray { tfar: hit.t, ..*ray }).collect();
        let at_end = closest(&single, &ending);
        // Rounding puts some hits before the flat boxes that hold them; of the others many are at the very entry of
        // theirs.
        assert!(at_end.iter().filter(|hit| hit.is_hit()).count() > rays.len() / 20, "{N} {isa}");
        let distances = |hits: &[Hit]| hits.iter().map(|hit| hit.t).collect::<Vec<_>>();
        assert_eq!(distances(&closest(&batch, &ending)), distances(&at_end), "{N} {isa}");
        assert_eq!(any(&batch, &ending), any(&single, &ending), "{N} {isa}");
    }
}

#[test]
fn batches_of_any_length_and_hits_against_brute_force() {
    let mesh = soup(1000, 7);
    let all = [camera(Vec3::new(0.0, 0.1, 3.0), 40), rays(&mesh, 1500, 8)].concat();
    let (tree, brute) = (median_tree::<8>(&mesh, 4), BruteForce(&mesh));
    let batch = BatchTracer::new(&tree);
    for count in [0, 1, 7, 63, 64, 65, 1023, 1024, 1025, all.len()] {
        let rays = &all[..count];
        let verdict = compare_closest(&mesh, rays, &closest(&brute, rays), &closest(&batch, rays));
        assert!(verdict.is_ok() && verdict.edge <= 15, "{count}: {verdict}");
    }
    assert!(closest(&batch, &all).iter().filter(|hit| hit.is_hit()).count() > 1000);
}

#[test]
fn nothing_is_hit_where_nothing_is() {
    let rays = camera(Vec3::Z, 10);
    let empty = mesh(vec![], vec![]);
    let tree = median_tree::<4>(&empty, 4);
    assert!(closest(&BatchTracer::new(&tree), &rays).iter().all(|hit| *hit == Hit::MISS));
    assert!(!any(&BatchTracer::new(&tree), &rays).contains(&true));
}
