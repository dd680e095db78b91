//! The watertight kernel: no ray leaves a closed mesh, and the hits are those of brute force.

use crate::trace_support::*;
use glam::Vec3;
use phr::builders;
use phr::geometry::{Hit, Mesh, Ray};
use phr::query::BvhError;
use phr::random::SplitMix64;
use phr::trace::verify::compare_closest;
use phr::trace::{BruteForce, Isa, WatertightTracer};
use phr::{Bvh, BvhConfig, WatertightBvh};

/// A sphere of radius `scale` around `centre`, of `2 * n * n` triangles that share their vertices.
fn sphere(n: usize, scale: f32, centre: Vec3) -> Mesh {
    let mut vertices = Vec::new();
    for i in 0..=n {
        let polar = std::f32::consts::PI * i as f32 / n as f32;
        for j in 0..n {
            let around = std::f32::consts::TAU * j as f32 / n as f32;
            let (s, c) = if i == 0 || i == n { (0.0, polar.cos()) } else { polar.sin_cos() };
            let place = Vec3::new(s * around.cos(), s * around.sin(), c);
            vertices.push((centre + scale * place).to_array());
        }
    }
    let at = |i: usize, j: usize| (i * n + j % n) as u32;
    let quads = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let triangles = quads.flat_map(|(i, j)| {
        [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]]
    });
    mesh(vertices, triangles.collect())
}

/// Rays from around `centre`, within half of `reach`, at vertices and edges of `mesh` and along axes.
fn inner_rays(mesh: &Mesh, centre: Vec3, reach: f32, count: usize, seed: u64) -> Vec<Ray> {
    let mut random = SplitMix64::new(seed);
    (0..count)
        .map(|i| {
            let org = centre + if i % 16 == 0 { Vec3::ZERO } else { 0.5 * reach * random.point(-0.5, 0.5) };
            let [a, b, c] = mesh.corners(random.below(mesh.len()) as u32).map(Vec3::from);
            let target = match i % 4 {
                0 => a,
                1 => a + random.unit() * (b - a),
                2 => b + random.unit() * (c - b),
                _ => a + (b - a) * 0.5,
            };
            let mut dir = target - org;
            if i % 32 == 5 {
                dir[random.below(3)] = 0.0;
            }
            Ray { org, tnear: 0.0, dir, tfar: f32::INFINITY }
        })
        .filter(|ray| ray.dir != Vec3::ZERO)
        .collect()
}

fn leaks<const N: usize>(mesh: &Mesh, rays: &[Ray], isa: Isa) -> usize {
    let tree = median_tree::<N>(mesh, 4);
    let tracer = WatertightTracer::with_isa(&tree, mesh, isa);
    // There is no code for AVX-512.
    assert_eq!(tracer.isa().name(), if isa == Isa::Scalar { "scalar" } else { "avx2" });
    let missed = closest(&tracer, rays).iter().filter(|hit| !hit.is_hit()).count();
    missed + any(&tracer, rays).iter().filter(|&&hit| !hit).count()
}

/// The tree that owns all it needs answers as the tracer, and tells normals.
#[test]
fn no_ray_leaves_a_watertight_bvh() {
    let mesh = sphere(48, 1.0, Vec3::ZERO);
    let rays = inner_rays(&mesh, Vec3::ZERO, 1.0, 20_000, 1);
    for (builder, width) in [("lbvh", 4), ("phr-quality", 8)] {
        let bvh = Bvh::build(&mesh, &BvhConfig { builder, width }).unwrap();
        let expected = match width {
            4 => closest(&WatertightTracer::new(bvh.as_bvh4().unwrap(), &mesh), &rays),
            _ => closest(&WatertightTracer::new(bvh.as_bvh8().unwrap(), &mesh), &rays),
        };
        let bytes = bvh.bytes();
        let watertight = WatertightBvh::new(bvh, &mesh).unwrap();
        assert!(watertight.bytes() > bytes);
        for (ray, expected) in rays.iter().zip(&expected) {
            let hit = watertight.intersect(ray).unwrap_or_else(|| panic!("{ray:?} leaves the sphere"));
            assert_eq!(Hit::from(hit), *expected);
            assert!(hit.normal.dot(ray.org + hit.t * ray.dir) != 0.0 && watertight.occluded(ray), "{ray:?}");
        }
        assert_eq!(closest(&watertight, &rays), expected);
        assert!(any(&watertight, &rays).iter().all(|&hit| hit));
        let invalid = Ray { tnear: -1.0, ..rays[0] };
        assert!(watertight.intersect(&invalid).is_none() && !watertight.occluded(&invalid));
        assert_eq!(watertight.get().len(), mesh.len());
        let other = sphere(48, 2.0, Vec3::ZERO);
        assert_eq!(WatertightBvh::new(watertight.into_inner(), &other).unwrap_err(), BvhError::NotOfMesh);
    }
}

#[test]
fn no_ray_leaves_a_sphere() {
    for isa in Isa::available() {
        for (scale, centre) in [
            (1.0, Vec3::ZERO),
            (1.0, Vec3::new(0.3, -0.1, 0.7)),
            (1e-6, Vec3::ZERO),
            (1e6, Vec3::ZERO),
            (1.0, Vec3::new(1000.0, -300.0, 50.0)),
        ] {
            let mesh = sphere(64, scale, centre);
            let rays = inner_rays(&mesh, centre, scale, 60_000, 1);
            assert_eq!(leaks::<4>(&mesh, &rays, isa), 0, "{isa}, width 4, radius {scale} around {centre}");
            assert_eq!(leaks::<8>(&mesh, &rays, isa), 0, "{isa}, width 8, radius {scale} around {centre}");
        }
    }
}

#[test]
fn no_ray_leaves_a_sphere_of_clipped_triangles() {
    // Long triangles, which the builder splits: the boxes of their parts are rounded where they were clipped.
    let round = sphere(48, 1.0, Vec3::ZERO);
    let slanted = |v: &[f32; 3]| [v[0] + 9.0 * v[2], v[1] + 7.0 * v[2], 20.0 * v[2]];
    let mesh = mesh(round.vertices().iter().map(slanted).collect(), round.triangles().to_vec());
    let tree = builders::by_name::<4>("phr-best").unwrap().build(&mesh).tree;
    assert!(tree.blocks.iter().map(|block| block.ids().count()).sum::<usize>() > mesh.len(), "splits");
    let rays = inner_rays(&mesh, Vec3::ZERO, 1.0, 60_000, 8);
    for isa in Isa::available() {
        let tracer = WatertightTracer::with_isa(&tree, &mesh, isa);
        assert_eq!(closest(&tracer, &rays).iter().filter(|hit| !hit.is_hit()).count(), 0, "{isa}");
    }
}

#[test]
fn no_ray_leaves_a_box_of_coplanar_triangles() {
    let mesh = walls(16);
    for isa in Isa::available() {
        let rays = inner_rays(&mesh, Vec3::ZERO, 1.0, 100_000, 2);
        assert_eq!(leaks::<4>(&mesh, &rays, isa), 0, "{isa}");
        assert_eq!(leaks::<8>(&mesh, &rays, isa), 0, "{isa}");
    }
}

#[test]
fn lengths_of_directions_do_not_matter() {
    let mesh = sphere(32, 1.0, Vec3::ZERO);
    for isa in Isa::available() {
        // From a distance beyond the numbers nothing is hit.
        for length in [1e-37, 1e-20, 1e-3, 1e10, 1e18] {
            let rays: Vec<Ray> = inner_rays(&mesh, Vec3::ZERO, 1.0, 2000, 3)
                .iter()
                .map(|ray| Ray { dir: ray.dir * length, ..*ray })
                .filter(|ray| ray.dir != Vec3::ZERO)
                .collect();
            assert_eq!(leaks::<4>(&mesh, &rays, isa), 0, "{isa}, directions of {length}");
        }
    }
}

#[test]
fn hits_are_those_of_brute_force() {
    for (mesh, seed) in [(soup(1500, 4), 5), (walls(6), 6), (sphere(24, 1.0, Vec3::ZERO), 7)] {
        let rays = rays(&mesh, 4000, seed);
        let reference = closest(&BruteForce(&mesh), &rays);
        for isa in Isa::available() {
            let tree = median_tree::<8>(&mesh, 11);
            let tracer = WatertightTracer::with_isa(&tree, &mesh, isa);
            let hits = closest(&tracer, &rays);
            let verdict = compare_closest(&mesh, &rays, &reference, &hits);
            assert!(verdict.is_ok() && verdict.edge * 50 <= rays.len(), "{isa}: {verdict}");
            for (hit, shadow) in hits.iter().zip(any(&tracer, &rays)) {
                assert_eq!(hit.is_hit(), shadow, "closest and any hit agree");
            }
        }
    }
}

/// From close above a level floor: its distance along a ray is a quotient of two small numbers, not a mean of far
/// corners.
#[test]
fn distances_of_grazing_rays_are_right() {
    let mesh = mesh(
        vec![[-9.0, -7.0, 0.25], [11.0, -8.0, 0.25], [10.0, 9.0, 0.25], [-8.0, 10.0, 0.25]],
        vec![[0, 1, 2], [0, 2, 3]],
    );
    let mut random = SplitMix64::new(9);
    let rays: Vec<Ray> = (0..20_000)
        .map(|i| {
            let mut point = |z: f32| Vec3::new(6.0 * random.unit() - 3.0, 6.0 * random.unit() - 3.0, z);
            let org = point(0.25 + 10f32.powi(-(i % 4) - 1));
            Ray { org, tnear: 0.0, dir: point(0.25) - org, tfar: f32::INFINITY }
        })
        .collect();
    let tree = median_tree::<8>(&mesh, 4);
    for isa in Isa::available() {
        let hits = closest(&WatertightTracer::with_isa(&tree, &mesh, isa), &rays);
        for (hit, ray) in hits.iter().zip(&rays) {
            let exact = (0.25 - f64::from(ray.org.z)) / f64::from(ray.dir.z);
            assert!((f64::from(hit.t) / exact - 1.0).abs() < 1e-6, "{isa}: {ray:?} {hit:?}, not {exact}");
        }
    }
}

#[test]
fn intervals_and_coordinates_are_those_of_the_fast_kernel() {
    let mesh = one_triangle();
    let tree = median_tree::<4>(&mesh, 4);
    let down = ray([0.25, 0.5, 2.0], [0.0, 0.0, -1.0]);
    for isa in Isa::available() {
        let tracer = WatertightTracer::with_isa(&tree, &mesh, isa);
        let hit = closest(&tracer, &[down])[0];
        assert_eq!(hit, Hit { t: 2.0, u: 0.25, v: 0.5, prim: 0 }, "{isa}: divided, not estimated");
        for (tnear, tfar, expected) in [
            (0.0, 2.0, true),
            (0.0, 2.0f32.next_down(), false),
            (2.0, 3.0, false),
            (2.0f32.next_down(), 3.0, true),
            (2.0, 2.0, false),
            (3.0, 1.0, false),
        ] {
            let ray = Ray { tnear, tfar, ..down };
            assert_eq!(closest(&tracer, &[ray])[0].is_hit(), expected, "{isa} {tnear}..{tfar}");
            assert_eq!(any(&tracer, &[ray])[0], expected, "{isa} {tnear}..{tfar}");
        }
        for bad in [
            Ray { dir: Vec3::ZERO, ..down },
            Ray { dir: Vec3::NAN, ..down },
            Ray { org: Vec3::INFINITY, ..down },
            Ray { tnear: f32::NAN, ..down },
            Ray { tnear: -1.0, ..down },
            Ray { tfar: f32::NAN, ..down },
        ] {
            assert_eq!(closest(&tracer, &[bad]), [Hit::MISS], "{isa} {bad:?}");
            assert_eq!(any(&tracer, &[bad]), [false], "{isa} {bad:?}");
        }
    }
}

#[test]
fn trees_of_other_meshes_are_refused() {
    let (whole, part) = (sphere(8, 1.0, Vec3::ZERO), sphere(7, 1.0, Vec3::ZERO));
    let tree = median_tree::<4>(&whole, 4);
    let rays = inner_rays(&whole, Vec3::ZERO, 1.0, 100, 3);
    let tracer = WatertightTracer::try_new(&tree, &whole).unwrap();
    assert_eq!(closest(&tracer, &rays), closest(&WatertightTracer::new(&tree, &whole), &rays));
    let refusal = WatertightTracer::try_new(&tree, &part).unwrap_err();
    assert_eq!(refusal, "the tree names triangle 127 of a mesh of 98; give the mesh of the tree");
    // A lane that is used after one that is not.
    let mut gap = tree.clone();
    gap.blocks[0].prims = [u32::MAX, u32::MAX, u32::MAX, 500];
    assert!(WatertightTracer::try_new(&gap, &whole).unwrap_err().contains("triangle 500"));
    gap.root = phr::bvh::Link::inner(1 << 20);
    assert!(WatertightTracer::try_new(&gap, &whole).unwrap_err().starts_with("malformed tree: link to node"));
}
