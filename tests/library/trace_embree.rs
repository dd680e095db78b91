//! Our kernel against Embree's: the same hits over any tree, the same bits over the same triangles.
#![cfg(feature = "embree")]

use crate::trace_support::*;
use glam::Vec3;
use phr::embree::{Config, Device, EmbreeBuilder, Width};
use phr::geometry::{Hit, Mesh, Ray};
use phr::scene::View;
use phr::trace::verify::{Verdict, compare_any, compare_closest, witness};
use phr::trace::{BvhTracer, Isa, PathSettings, RayKind, record};

/// Embree's device as it comes, and limited to AVX2, each with our kernel that has its arithmetic: with AVX-512
/// both start from another estimate of reciprocals.
fn devices(config: &Config) -> [(Device, &'static str); 2] {
    #[cfg(target_arch = "x86_64")]
    let embrees = if is_x86_feature_detected!("avx512vl") { "avx512" } else { "avx2" };
    #[cfg(not(target_arch = "x86_64"))]
    let embrees = "";
    let limited = Device::limited(config, "avx2").unwrap();
    assert!(limited.config().ends_with(",max_isa=avx2"));
    [(Device::new(config).unwrap(), embrees), (limited, "avx2")]
}

fn meshes() -> Vec<(&'static str, Mesh, Vec<Ray>)> {
    let all = [("soup", soup(3000, 1)), ("walls", walls(12)), ("both", joined(&walls(5), &soup(1000, 2)))];
    all.into_iter()
        .map(|(name, mesh)| {
            let mut rays = rays(&mesh, 6000, 3);
            let view = View { eye: Vec3::splat(0.9), target: Vec3::ZERO, up: Vec3::Y, fov_y_deg: 80.0 };
            let tree = median_tree::<4>(&mesh, 4);
            let settings = PathSettings { width: 48, height: 48, ..PathSettings::default() };
            let recording = record(&BvhTracer::new(&tree), &mesh, &view, &settings);
            for kind in RayKind::ALL {
                rays.extend_from_slice(recording.batches.get(kind));
            }
            assert!(rays.iter().all(Ray::is_valid));
            (name, mesh, rays)
        })
        .collect()
}

fn bits(hit: &Hit) -> [u32; 3] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits()]
}

fn assert_alike(what: &str, verdict: &Verdict) {
    assert!(
        verdict.is_ok() && (verdict.edge + verdict.near_misses) * 100 <= verdict.rays,
        "{what}: {verdict}"
    );
}

#[test]
fn hits_equal_embrees_over_trees_of_our_own() {
    for (name, mesh, rays) in meshes() {
        let (four, eight) = (median_tree::<4>(&mesh, 4), median_tree::<8>(&mesh, 4));
        for builder in EmbreeBuilder::ALL {
            for (device, embrees) in devices(&Config { builder, width: Width::Four, threads: 2 }) {
                let scene = device.prepare(&mesh).unwrap().commit().unwrap();
                let (reference, occluded) = (closest(&scene, &rays), any(&scene, &rays));
                for isa in Isa::available() {
                    let tracer = BvhTracer::with_isa(&four, isa);
                    let what = format!("{name} {} {isa}", device.config());
                    let hits = closest(&tracer, &rays);
                    assert_alike(&what, &compare_closest(&mesh, &rays, &reference, &hits));
                    let shadows = any(&tracer, &rays);
                    let both = compare_any(&mesh, &rays, &occluded, &shadows, witness(&[&scene, &tracer]));
                    assert_alike(&what, &both);
                    let wide = closest(&BvhTracer::with_isa(&eight, isa), &rays);
                    assert_alike(&what, &compare_closest(&mesh, &rays, &reference, &wide));
                    if isa.name() == embrees {
                        let same = reference.iter().zip(&hits).filter(|(a, b)| a.prim == b.prim);
                        let differ = same.filter(|(a, b)| bits(a) != bits(b)).count();
                        assert_eq!(differ, 0, "{what}: other bits for the same triangle");
                    }
                }
            }
        }
    }
}

#[cfg(feature = "graft")]
#[test]
fn hits_over_embrees_own_trees_are_its_very_bits() {
    use phr::embree::native::{read4, read8};
    for (name, mesh, rays) in meshes() {
        for (builder, width) in
            EmbreeBuilder::ALL.into_iter().flat_map(|b| [(b, Width::Four), (b, Width::Eight)])
        {
            for (device, embrees) in devices(&Config { builder, width, threads: 2 }) {
                let scene = device.prepare(&mesh).unwrap().commit().unwrap();
                let (reference, occluded) = (closest(&scene, &rays), any(&scene, &rays));
                for isa in Isa::available() {
                    let traced = match width {
                        Width::Four => read4(&scene).map(|tree| {
                            let tracer = BvhTracer::with_isa(&tree, isa);
                            (closest(&tracer, &rays), any(&tracer, &rays))
                        }),
                        Width::Eight => read8(&scene).map(|tree| {
                            let tracer = BvhTracer::with_isa(&tree, isa);
                            (closest(&tracer, &rays), any(&tracer, &rays))
                        }),
                    };
                    let Ok((hits, shadows)) = traced else {
                        let version = phr::embree::version();
                        assert!(
                            !["3.13.5", "4.3.3"].contains(&version.as_str()),
                            "Embree {version} is known"
                        );
                        println!("not compared: the trees of Embree {version} cannot be read");
                        return;
                    };
                    let what = format!("{name} {} {isa}", device.config());
                    let verdict = compare_closest(&mesh, &rays, &reference, &hits);
                    assert_alike(&what, &verdict);
                    if isa.name() == embrees {
                        let differ = (0..rays.len()).filter(|&i| {
                            reference[i].prim == hits[i].prim && bits(&reference[i]) != bits(&hits[i])
                        });
                        assert_eq!(differ.count(), 0, "{what}: rays differ in bits");
                        assert_eq!(verdict.edge + verdict.near_misses, 0, "{what}: {verdict}");
                        assert_eq!(occluded, shadows, "{what}");
                    }
                }
            }
        }
    }
}
