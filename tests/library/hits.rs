//! Every builder's tree gives Embree's hits, on every built-in scene and, where they are, on the small scenes
//! of the folder that `PHR_SCENES` names (`../shared/scenes` if unset): same hit or miss, distances within
//! 1e-5, ties and edges settled by the oracle.

#![cfg(all(feature = "embree", feature = "files"))]

use crate::thorough;
use phr::builders;
use phr::embree::{Config, Device, EmbreeBuilder, EmbreeScene, Width};
use phr::geometry::{Hit, Ray, Tracer};
use phr::scene::{self, Scene};
use phr::trace::verify::{compare_any, compare_closest, witness};
use phr::trace::{BvhTracer, Isa, PathSettings, RayKind, record};
use std::path::PathBuf;

/// Scenes of larger files are left to the command line's `verify`; without time for more, all but the smallest.
fn largest_file() -> u64 {
    if thorough() { 2_000_000 } else { 1_000_000 }
}

fn shared_scenes() -> Vec<PathBuf> {
    let folder = std::env::var_os("PHR_SCENES")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes"), PathBuf::from);
    let Ok(entries) = std::fs::read_dir(&folder) else {
        assert!(std::env::var_os("PHR_SCENES").is_none(), "PHR_SCENES: no folder {}", folder.display());
        println!("skipped: no scenes in {}", folder.display());
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.to_string_lossy().ends_with(".ply.zst"))
        .filter(|path| path.metadata().is_ok_and(|meta| meta.len() < largest_file()))
        .collect();
    files.sort();
    files
}

/// Recorded rays of one kind with Embree's answers.
enum Answered {
    Closest(Vec<Ray>, Vec<Hit>),
    Any(Vec<Ray>, Vec<bool>),
}

/// Rays of all views, traced by Embree through its SAH tree and by our kernels through each of our trees, compared.
fn check(scene: &Scene) {
    let config = Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads: 2 };
    let device = Device::new(&config).unwrap();
    let embree = device.prepare(&scene.mesh).unwrap().commit().unwrap();
    let settings = PathSettings { width: 48, height: 48, max_depth: 8, seed: 5 };
    let recorded = scene.views.iter().map(|view| record(&embree, &scene.mesh, view, &settings).batches);
    let answered: Vec<_> = recorded
        .flat_map(|batches| RayKind::ALL.map(|kind| (kind, answers(&embree, batches.get(kind), kind))))
        .collect();
    for name in builders::NAMES {
        check_builder::<4>(name, scene, &embree, &answered);
        check_builder::<8>(name, scene, &embree, &answered);
    }
}

fn answers(embree: &EmbreeScene<'_>, rays: &[Ray], kind: RayKind) -> Answered {
    assert!(!rays.is_empty(), "no {} rays", kind.name());
    if kind.is_any_hit() {
        Answered::Any(rays.to_vec(), any(embree, rays))
    } else {
        Answered::Closest(rays.to_vec(), closest(embree, rays))
    }
}

fn any(tracer: &impl Tracer, rays: &[Ray]) -> Vec<bool> {
    let mut hits = vec![false; rays.len()];
    tracer.any(rays, &mut hits);
    hits
}

fn closest(tracer: &impl Tracer, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = vec![Hit::MISS; rays.len()];
    tracer.closest(rays, &mut hits);
    hits
}

fn check_builder<const N: usize>(
    name: &str,
    scene: &Scene,
    embree: &EmbreeScene<'_>,
    answered: &[(RayKind, Answered)],
) {
    let tree = builders::by_name::<N>(name).unwrap().build(&scene.mesh).tree;
    tree.validate(&scene.mesh)
        .unwrap_or_else(|invalid| panic!("{name}, width {N}, on {}: {invalid}", scene.name));
    let isas = if thorough() { vec![Isa::Scalar, Isa::best()] } else { vec![Isa::best()] };
    for isa in isas {
        let ours = BvhTracer::with_isa(&tree, isa);
        for (kind, answered) in answered {
            let (rays, verdict) = match answered {
                Answered::Closest(rays, hits) => {
                    (rays, compare_closest(&scene.mesh, rays, hits, &closest(&ours, rays)))
                }
                Answered::Any(rays, hits) => {
                    let ours_hits = any(&ours, rays);
                    (rays, compare_any(&scene.mesh, rays, hits, &ours_hits, witness(&[embree, &ours])))
                }
            };
            assert!(
                verdict.is_ok() && verdict.edge * 1000 <= rays.len(),
                "{name}, width {N}, {}, {} rays on {}: {verdict:?}",
                isa.name(),
                kind.name(),
                scene.name
            );
        }
    }
}

#[test]
fn built_in_scenes_give_embrees_hits() {
    for generator in scene::builtin() {
        check(&generator.generate());
    }
}

#[test]
fn small_real_scenes_give_embrees_hits() {
    for path in shared_scenes() {
        check(&scene::load(&path).unwrap());
    }
}
