//! All kernels answer alike: scalar, AVX2 and AVX-512, both widths, over rays and scenes at the limits.

use crate::trace_support::*;
use glam::Vec3;
use phr::geometry::{Hit, Mesh, Ray, Tracer};
use phr::random::SplitMix64;
use phr::trace::verify::{compare_any, compare_closest, witness};
use phr::trace::{BatchTracer, BruteForce, BvhTracer, Isa, WatertightTracer};

/// What a case leaves open.
struct Case {
    what: &'static str,
    /// Rays per thousand that rounding may decide, at most.
    edge: usize,
    /// Rays per thousand that hit something, at least: where none does, nothing is compared.
    hit: usize,
    /// Rays per thousand that Embree's robust kernel may answer wrongly: far from the origin of a ray it rounds by more
    /// than a small triangle.
    #[cfg_attr(not(feature = "embree"), allow(dead_code, reason = "there is no such kernel"))]
    robust: usize,
}

/// Rays with the answers that are held to be right.
struct Asked<'a> {
    rays: &'a [Ray],
    hits: Vec<Hit>,
    shadows: Vec<bool>,
}

impl<'a> Asked<'a> {
    fn of(reference: &dyn Tracer, rays: &'a [Ray]) -> Self {
        Self { rays, hits: closest(reference, rays), shadows: any(reference, rays) }
    }
}

/// Holds the answers of every instruction set, width and kernel, of brute force and of Embree to those of our
/// scalar kernel over four children.
fn agree(case: &Case, mesh: &Mesh, rays: &[Ray]) {
    let Case { what, edge, hit, .. } = *case;
    let (four, eight) = (median_tree::<4>(mesh, 4), median_tree::<8>(mesh, 11));
    let reference = BvhTracer::with_isa(&four, Isa::Scalar);
    let asked = Asked::of(&reference, rays);
    let found = asked.hits.iter().filter(|hit| hit.is_hit()).count();
    assert!(found * 1000 >= hit * rays.len(), "{what}: {found} of {} rays hit", rays.len());
    let compare = |name: &str, tracer: &dyn Tracer, asked: &Asked<'_>, wrong: usize| {
        let Asked { rays, hits, shadows } = asked;
        let found = closest(tracer, rays);
        let verdict = compare_closest(mesh, rays, hits, &found);
        let [is_right, is_sure] = [(verdict.mismatched, wrong), (verdict.edge, edge)]
            .map(|(count, most)| count * 1000 <= most * rays.len());
        assert!(is_right && is_sure, "{what}, {name}: {verdict}");
        let occluded = any(tracer, rays);
        let verdict = compare_any(mesh, rays, shadows, &occluded, witness(&[&reference, tracer]));
        assert!(verdict.mismatched * 1000 <= wrong * rays.len(), "{what}, {name}, any hit: {verdict}");
        for ((hit, shadow), ray) in found.iter().zip(occluded).zip(*rays) {
            assert_eq!(hit.is_hit(), shadow, "{what}, {name}: closest and any hit disagree on {ray:?}");
        }
    };
    let check = |name: &str, tracer: &dyn Tracer| compare(name, tracer, &asked, 0);
    for isa in Isa::available() {
        check(&format!("{isa}, width 4"), &BvhTracer::with_isa(&four, isa));
        check(&format!("{isa}, width 8"), &BvhTracer::with_isa(&eight, isa));
        check(&format!("{isa}, batches, width 4"), &BatchTracer::with_isa(&four, isa));
        check(&format!("{isa}, batches, width 8"), &BatchTracer::with_isa(&eight, isa));
        check(&format!("{isa}, watertight, width 4"), &WatertightTracer::with_isa(&four, mesh, isa));
        check(&format!("{isa}, watertight, width 8"), &WatertightTracer::with_isa(&eight, mesh, isa));
    }
    check("brute force", &BruteForce(mesh));
    #[cfg(feature = "embree")]
    for width in phr::embree::Width::ALL {
        use phr::embree::{Config, Device, EmbreeBuilder};
        let config = Config { builder: EmbreeBuilder::Sah, width, threads: 2 };
        let device = Device::new(&config).unwrap();
        check(device.config(), &device.prepare(mesh).unwrap().commit().unwrap());
        // Embree's robust kernel takes a hit at the very start of the interval, too: these begin behind it.
        let behind: Vec<Ray> =
            rays.iter().map(|ray| Ray { tnear: ray.tnear.max(f32::MIN_POSITIVE), ..*ray }).collect();
        let device = Device::robust(&config).unwrap();
        let scene = device.prepare(mesh).unwrap().commit().unwrap();
        compare(device.config(), &scene, &Asked::of(&reference, &behind), case.robust);
    }
}

fn ray_of(org: Vec3, dir: Vec3) -> Ray {
    Ray { org, tnear: 0.0, dir, tfar: f32::INFINITY }
}

fn made(count: usize, seed: u64, mut ray: impl FnMut(&mut SplitMix64) -> Ray) -> Vec<Ray> {
    let mut random = SplitMix64::new(seed);
    (0..count).map(|_| ray(&mut random)).collect()
}

#[test]
fn over_random_rays_at_all_scales() {
    let small = soup(1000, 1);
    let random = rays(&small, 4000, 2);
    for scale in [1e-6, 1.0, 1e6] {
        let placed = |v: &[f32; 3]| v.map(|x| x * scale);
        let mesh = mesh(small.vertices().iter().map(placed).collect(), small.triangles().to_vec());
        let unscaled = random.iter().map(|ray| {
            let [tnear, tfar] = [ray.tnear * scale, ray.tfar * scale];
            Ray { org: ray.org * scale, tnear, tfar, ..*ray }
        });
        let case = |what| Case { what, edge: 5, hit: 300, robust: 0 };
        agree(&case("scenes scaled"), &mesh, &unscaled.collect::<Vec<_>>());
        let scaled = random.iter().map(|ray| Ray { org: ray.org * scale, dir: ray.dir * scale, ..*ray });
        agree(&case("directions scaled with the scene"), &mesh, &scaled.collect::<Vec<_>>());
    }
}

#[test]
fn over_rays_along_axes() {
    for mesh in [soup(1000, 3), walls(7)] {
        let rays = made(4000, 4, |random| {
            let mut dir = Vec3::ZERO;
            dir[random.below(3)] = if random.unit() < 0.5 { -1.0 } else { 2.0 };
            ray_of(1.5 * random.point(-1.0, 1.0), dir)
        });
        agree(&Case { what: "along axes", edge: 20, hit: 300, robust: 0 }, &mesh, &rays);
    }
}

#[test]
fn over_rays_in_planes_of_triangles() {
    for mesh in [soup(500, 5), walls(7)] {
        let rays = made(4000, 6, |random| {
            let [a, b, c] = mesh.corners(random.below(mesh.len()) as u32).map(Vec3::from);
            let (u, v) = (random.unit() * 3.0 - 1.0, random.unit() * 3.0 - 1.0);
            let org = a + u * (b - a) + v * (c - a);
            ray_of(org, a + random.unit() * (b - a) + random.unit() * (c - a) - org)
        });
        agree(&Case { what: "in planes", edge: 500, hit: 300, robust: 0 }, &mesh, &rays);
    }
}

#[test]
fn over_rays_from_far_away() {
    let mesh = soup(300, 7);
    let rays = made(4000, 8, |random| {
        let away = random.point(-1.0, 1.0).normalize_or(Vec3::X);
        let org = 1e6 * away;
        ray_of(org, random.point(-1.0, 1.0) - org)
    });
    agree(&Case { what: "from far away", edge: 200, hit: 300, robust: 1 }, &mesh, &rays);
}

#[test]
fn over_denormal_and_zero_components() {
    let tiny = [0.0, -0.0, 1e-40, -1e-40, f32::MIN_POSITIVE, 1e-30, -1e-19];
    for mesh in [soup(1000, 9), walls(7)] {
        let rays = made(4000, 10, |random| {
            let mut dir = random.point(-1.0, 1.0);
            for _ in 0..2 {
                dir[random.below(3)] = tiny[random.below(tiny.len())];
            }
            let mut org = random.point(-1.2, 1.2);
            org[random.below(3)] = tiny[random.below(tiny.len())];
            ray_of(org, dir)
        });
        agree(&Case { what: "tiny components", edge: 30, hit: 300, robust: 0 }, &mesh, &rays);
    }
}

#[test]
fn over_intervals_of_one_point() {
    let mesh = soup(1000, 11);
    at_one_point::<4>(&mesh);
    at_one_point::<8>(&mesh);
}

/// An interval is open at its start: at the very distance of a hit there is nothing within it, but in one that
/// begins just before, there is, where rounding allows.
fn at_one_point<const N: usize>(mesh: &Mesh) {
    let tree = median_tree::<N>(mesh, 4);
    let rays = rays(mesh, 3000, 12);
    for isa in Isa::available() {
        let watertight = WatertightTracer::with_isa(&tree, mesh, isa);
        let (single, batch) = (BvhTracer::with_isa(&tree, isa), BatchTracer::with_isa(&tree, isa));
        for tracer in [&single as &dyn Tracer, &batch, &watertight] {
            let hits = closest(tracer, &rays);
            let at: Vec<(Ray, Hit)> =
                rays.iter().copied().zip(hits).filter(|(_, hit)| hit.is_hit()).collect();
            let within = |begin: fn(f32) -> f32, end: fn(f32) -> f32| -> Vec<Ray> {
                at.iter().map(|(ray, hit)| Ray { tnear: begin(hit.t), tfar: end(hit.t), ..*ray }).collect()
            };
            let points = within(|t| t, |t| t);
            assert!(closest(tracer, &points).iter().all(|hit| *hit == Hit::MISS), "{isa}");
            assert!(!any(tracer, &points).contains(&true), "{isa}");
            let around = within(|t| t * 0.99999, |t| t * 1.00001);
            let again = closest(tracer, &around);
            let same = again.iter().zip(&at).filter(|(again, (_, hit))| again.t == hit.t).count();
            assert!(at.len() > 500 && same * 100 >= 99 * at.len(), "{isa}: {same} of {}", at.len());
        }
    }
}

#[test]
fn over_invalid_rays() {
    let mesh = soup(500, 13);
    let (four, eight) = (median_tree::<4>(&mesh, 4), median_tree::<8>(&mesh, 4));
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, 2e18];
    let rays = made(4000, 14, |random| {
        let mut x = [0.0; 8].map(|_: f32| random.range(-1.0, 1.0));
        (x[6], x[7]) = (x[6].abs(), f32::INFINITY);
        x[random.below(6)] = bad[random.below(bad.len())];
        match random.below(4) {
            0 => x[6] = -1.0,
            1 => x[6] = [f32::NAN, f32::INFINITY][random.below(2)],
            2 => x[7] = f32::NAN,
            _ => {}
        }
        Ray { org: Vec3::new(x[0], x[1], x[2]), tnear: x[6], dir: Vec3::new(x[3], x[4], x[5]), tfar: x[7] }
    });
    assert!(!rays.iter().any(Ray::is_valid));
    // Valid, but without a direction nothing is hit either.
    let still = rays.iter().map(|_| ray_of(Vec3::ZERO, Vec3::ZERO)).take(100);
    let rays: Vec<Ray> = rays.iter().copied().chain(still).collect();
    for isa in Isa::available() {
        let watertight = WatertightTracer::with_isa(&eight, &mesh, isa);
        let tracers: [&dyn Tracer; 5] = [
            &BvhTracer::with_isa(&four, isa),
            &BvhTracer::with_isa(&eight, isa),
            &BatchTracer::with_isa(&four, isa),
            &BatchTracer::with_isa(&eight, isa),
            &watertight,
        ];
        for tracer in tracers {
            assert!(closest(tracer, &rays).iter().all(|hit| *hit == Hit::MISS), "{isa}");
            assert!(!any(tracer, &rays).contains(&true), "{isa}");
        }
    }
}
