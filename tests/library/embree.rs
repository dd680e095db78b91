//! Embree through its safe wrapper: hits, invalid rays, memory, bad devices.
#![cfg(feature = "embree")]

use crate::trace_support;
use glam::Vec3;
use phr::bvh::{Statistics, WideBvh};
use phr::embree::{Config, Device, EmbreeBuilder, Width, inspect, version};
use phr::geometry::{Hit, Mesh, Ray, Tracer};
use phr::random::SplitMix64;
use phr::trace::verify::{compare_any, compare_closest, witness};
use phr::trace::{BruteForce, BvhTracer};

const SAH4: Config = Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads: 2 };

/// A unit square in the plane z = 0: triangle 0 below the diagonal, 1 above.
fn square() -> Mesh {
    let vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    Mesh::new(vertices, vec![[0, 1, 2], [1, 3, 2]]).unwrap().0
}

/// A wavy sheet of 2 n^2 triangles.
fn sheet(n: u32) -> Mesh {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
        let (x, y) = (i as f32 / n as f32, j as f32 / n as f32);
        vertices.push([x, y, 0.1 * (20.0 * x).sin() * (15.0 * y).cos()]);
        if i < n && j < n {
            let a = i * (n + 1) + j;
            triangles.extend([[a, a + n + 1, a + 1], [a + 1, a + n + 1, a + n + 2]]);
        }
    }
    Mesh::new(vertices, triangles).unwrap().0
}

fn down(x: f32, y: f32) -> Ray {
    Ray { org: Vec3::new(x, y, 2.0), tnear: 0.0, dir: Vec3::new(0.0, 0.0, -1.0), tfar: f32::INFINITY }
}

fn closest(tracer: &dyn Tracer, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = vec![Hit::MISS; rays.len()];
    tracer.closest(rays, &mut hits);
    hits
}

fn any(tracer: &dyn Tracer, rays: &[Ray]) -> Vec<bool> {
    let mut occluded = vec![false; rays.len()];
    tracer.any(rays, &mut occluded);
    occluded
}

fn near(hit: Hit, t: f32, u: f32, v: f32) -> bool {
    [hit.t - t, hit.u - u, hit.v - v].iter().all(|difference| difference.abs() < 1e-5)
}

#[test]
fn hits_carry_distance_barycentrics_and_triangle() {
    let mesh = square();
    for width in Width::ALL {
        for builder in EmbreeBuilder::ALL {
            let device = Device::new(&Config { builder, width, threads: 1 }).unwrap();
            let scene = device.prepare(&mesh).unwrap().commit().unwrap();
            assert_eq!(scene.bounds(), mesh.bounds());
            let mut short = down(0.25, 0.125);
            short.tfar = 1.5;
            let mut backward = short;
            backward.tfar = f32::NEG_INFINITY;
            let rays = [down(0.25, 0.125), down(0.75, 0.5), down(2.0, 0.0), short, backward];
            let hits = closest(&scene, &rays);
            assert!(near(hits[0], 2.0, 0.25, 0.125) && hits[0].prim == 0, "{hits:?}");
            assert!(near(hits[1], 2.0, 0.25, 0.25) && hits[1].prim == 1, "{hits:?}");
            assert_eq!(hits[2..], [Hit::MISS; 3]);
            assert_eq!(any(&scene, &rays), [true, true, false, false, false]);
        }
    }
}

#[test]
fn invalid_rays_miss_and_leave_the_others_alone() {
    let mesh = square();
    let device = Device::new(&SAH4).unwrap();
    let scene = device.prepare(&mesh).unwrap().commit().unwrap();
    let good = down(0.25, 0.125);
    let mut rays = vec![good; 1000];
    rays[1].org.x = f32::NAN;
    rays[300].dir.y = f32::NAN;
    rays[301].tnear = -1.0;
    rays[302].tnear = f32::NAN;
    rays[303].tfar = f32::NAN;
    rays[304].org.z = 3e18;
    rays[999].dir.z = f32::NEG_INFINITY;
    let invalid = [1, 300, 301, 302, 303, 304, 999];
    let hits = closest(&scene, &rays);
    let occluded = any(&scene, &rays);
    for (i, (hit, occluded)) in hits.iter().zip(occluded).enumerate() {
        assert_eq!((hit.is_hit(), occluded), (!invalid.contains(&i), !invalid.contains(&i)), "ray {i}");
    }
}

#[test]
fn scenes_without_triangles_are_missed() {
    let mesh = Mesh::new(vec![], vec![]).unwrap().0;
    for width in Width::ALL {
        for builder in EmbreeBuilder::ALL {
            let device = Device::new(&Config { builder, width, threads: 1 }).unwrap();
            let scene = device.prepare(&mesh).unwrap().commit().unwrap();
            assert!(scene.bounds().is_empty());
            assert_eq!(closest(&scene, &[down(0.0, 0.0)]), [Hit::MISS]);
            assert_eq!(any(&scene, &[down(0.0, 0.0)]), [false]);
        }
    }
}

#[test]
fn memory_is_counted_and_given_back() {
    let mesh = sheet(100);
    let device = Device::new(&SAH4).unwrap();
    let scene = device.prepare(&mesh).unwrap().commit().unwrap();
    let held = device.memory();
    assert!(held.live_bytes > 40 * mesh.len() && held.peak_bytes > held.live_bytes, "{held:?}");
    drop(scene);
    assert_eq!(device.memory().live_bytes, 0);
    assert_eq!(device.memory().peak_bytes, held.peak_bytes);
    device.reset_peak();
    assert_eq!(device.memory().peak_bytes, 0);
}

#[test]
fn threads_share_a_scene() {
    let mesh = sheet(40);
    let device = Device::new(&SAH4).unwrap();
    let scene = device.prepare(&mesh).unwrap().commit().unwrap();
    let rays: Vec<Ray> = (0..2000).map(|i| down(i as f32 / 2000.0, (i % 37) as f32 / 37.0)).collect();
    let alone = closest(&scene, &rays);
    assert!(alone.iter().all(Hit::is_hit));
    std::thread::scope(|threads| {
        for _ in 0..4 {
            threads.spawn(|| assert_eq!(closest(&scene, &rays), alone));
        }
    });
}

#[test]
fn the_library_tells_its_version() {
    let major = if cfg!(embree4) { "4." } else { "3." };
    assert!(version().starts_with(major), "{}", version());
}

/// Trees of each builder by `rtcBuildBVH`: valid, about as cheap as the scene's own, and hit where brute force hits.
fn built_without_a_scene<const N: usize>(name: &str, mesh: &Mesh, width: Width) {
    let rays = trace_support::rays(mesh, 3000, 5);
    let (expected, occluded) = (closest(&BruteForce(mesh), &rays), any(&BruteForce(mesh), &rays));
    for builder in EmbreeBuilder::ALL {
        let config = Config { builder, width, threads: 2 };
        let device = Device::new(&config).unwrap();
        let tree: WideBvh<N> = device.build_bvh(builder, mesh).unwrap();
        assert_eq!(device.memory().live_bytes, 0);
        let what = format!("{name}, {}", device.config());
        tree.validate(mesh).unwrap_or_else(|error| panic!("{what}: {error}"));
        let (found, printed) = (Statistics::of(&tree, mesh), inspect(mesh, &config).unwrap());
        // The scene's 4-wide tree of Morton codes has rotations.
        let most = if builder == EmbreeBuilder::Morton { 1.5 } else { 1.02 };
        assert!(
            found.sah >= 0.98 * printed.sah && found.sah <= most * printed.sah,
            "{what}: {found:?} {printed:?}"
        );
        let may_split = builder == EmbreeBuilder::FastSpatial;
        assert!(may_split || found.references == mesh.len(), "{what}: {found:?}");
        assert!(!may_split || name != "needles" || found.references > mesh.len(), "{what}: {found:?}");
        let tracer = BvhTracer::new(&tree);
        let verdict = compare_closest(mesh, &rays, &expected, &closest(&tracer, &rays));
        assert!(verdict.is_ok(), "{what}: {verdict}");
        let hits = any(&tracer, &rays);
        let verdict = compare_any(mesh, &rays, &occluded, &hits, witness(&[&BruteForce(mesh), &tracer]));
        assert!(verdict.is_ok(), "{what}: {verdict}");
    }
}

#[test]
fn trees_built_without_a_scene_are_right() {
    // Long and thin triangles in all directions, which are worth splitting.
    let mut random = SplitMix64::new(4);
    let mut needle = || {
        let corner = random.point(-1.0, 0.3);
        [corner, corner + random.point(0.0, 0.7), corner + random.point(0.0, 0.02)].map(|v| v.to_array())
    };
    let needles = trace_support::mesh(
        (0..2000).flat_map(|_| needle()).collect(),
        (0..2000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    );
    let both = trace_support::joined(&trace_support::walls(5), &trace_support::soup(1000, 2));
    for (name, mesh) in [
        ("nothing", trace_support::soup(0, 1)),
        ("one triangle", trace_support::one_triangle()),
        ("soup", trace_support::soup(3000, 1)),
        ("walls and soup", both),
        ("needles", needles),
    ] {
        built_without_a_scene::<4>(name, &mesh, Width::Four);
        built_without_a_scene::<8>(name, &mesh, Width::Eight);
    }
}

#[test]
#[cfg(feature = "graft")]
fn trees_built_without_a_scene_are_the_scenes() {
    let mesh = trace_support::soup(3000, 1);
    for builder in [EmbreeBuilder::Sah, EmbreeBuilder::FastSpatial] {
        let device = Device::new(&Config { builder, width: Width::Four, threads: 2 }).unwrap();
        let scene = device.prepare(&mesh).unwrap().commit().unwrap();
        let Ok(read) = phr::embree::native::read4(&scene) else { return };
        assert!(device.build_bvh::<4>(builder, &mesh).unwrap() == read, "{builder:?}: trees differ");
    }
}

/// On a scanned model, where it is at hand: costs of trees as read, and hits of trees set back.
#[test]
#[cfg(all(feature = "graft", feature = "files"))]
fn a_scanned_models_trees_are_read_and_set_back() {
    use phr::bvh::sah_cost;
    use phr::embree::{graft::Graft, inspect, native};

    let folder = std::env::var_os("PHR_SCENES").map_or_else(
        || concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/scenes").into(),
        std::path::PathBuf::from,
    );
    let file = folder.join("bunny_144k.ply.zst");
    if !file.exists() {
        println!("skipped: no {}", file.display());
        return;
    }
    let mesh = phr::scene::load(&file).unwrap().mesh;
    let bounds = mesh.bounds();
    // Points on a fixed lattice of fractions, none alike.
    let point = |i: u32, step: f32| {
        let fraction = glam::Vec3::new(0.7548777, 0.5698403, 0.3694124) * (i as f32 * step);
        (bounds.min + bounds.extent() * glam::Vec3A::from(fraction.fract())).into()
    };
    let rays: Vec<Ray> = (1..=100_000)
        .map(|i| {
            let (from, to): (Vec3, Vec3) = (point(i, 0.37), point(i, 0.83));
            Ray { org: from, tnear: 0.0, dir: to - from, tfar: f32::INFINITY }
        })
        .collect();
    for builder in EmbreeBuilder::ALL {
        let config = Config { builder, width: Width::Four, threads: 2 };
        let printed = inspect(&mesh, &config).unwrap();
        let device = Device::new(&config).unwrap();
        let scene = device.prepare(&mesh).unwrap().commit().unwrap();
        let Ok(tree) = native::read4(&scene) else { return };
        assert!(
            (sah_cost(&tree) / printed.sah - 1.0).abs() < 1e-5,
            "{builder:?}: {} {printed:?}",
            sah_cost(&tree)
        );
        let native = closest(&scene, &rays);
        assert!(native.iter().filter(|hit| hit.is_hit()).count() > 20_000);
        let graft = Graft::new(scene, &tree).unwrap();
        assert!(closest(&graft, &rays) == native, "{builder:?}: hits differ");
    }
}
