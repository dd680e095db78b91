//! Every builder's tree gives Embree's hits, on every built-in scene and, where they are, on the small scenes
//! of the folder that `PHR_SCENES` names (`../shared/scenes` if unset): same hit or miss, distances within
//! 1e-5, ties and edges settled by the oracle.

#![cfg(all(feature = "embree", feature = "files"))]

use phr::builders;
use phr::embree::{Config, Device, EmbreeBuilder, EmbreeScene, Width};
use phr::geometry::{Hit, Tracer};
use phr::scene::{self, Scene};
use phr::trace::verify::{compare_any, compare_closest, witness};
use phr::trace::{BvhTracer, Isa, PathSettings, RayKind, record};
use std::path::PathBuf;

/// Scenes above this size are left to the command line's `verify`.
const SMALL_FILE: u64 = 2_000_000;

fn shared_scenes() -> Vec<PathBuf> {
    let folder = std::env::var_os("PHR_SCENES")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes"), PathBuf::from);
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("skipped: no scenes in {}", folder.display());
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.to_string_lossy().ends_with(".ply.zst"))
        .filter(|path| path.metadata().is_ok_and(|meta| meta.len() < SMALL_FILE))
        .collect();
    files.sort();
    files
}

/// Rays of all views, their answers by Embree's SAH tree, and those of each of our trees, compared.
fn check(scene: &Scene) {
    let config = Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads: 2 };
    let device = Device::new(&config).unwrap();
    let embree = device.prepare(&scene.mesh).unwrap().commit().unwrap();
    for name in builders::NAMES {
        check_builder::<4>(name, scene, &embree);
        check_builder::<8>(name, scene, &embree);
    }
}

fn check_builder<const N: usize>(name: &str, scene: &Scene, embree: &EmbreeScene<'_>) {
    let settings = PathSettings { width: 48, height: 48, max_depth: 8, seed: 5 };
    let tree = builders::by_name::<N>(name).unwrap().build(&scene.mesh).tree;
    tree.validate(&scene.mesh)
        .unwrap_or_else(|invalid| panic!("{name}, width {N}, on {}: {invalid}", scene.name));
    for isa in [Isa::Scalar, Isa::best()] {
        let ours = BvhTracer::with_isa(&tree, isa);
        for view in &scene.views {
            let batches = record(embree, &scene.mesh, view, &settings).batches;
            assert!(!batches.primary.is_empty() && !batches.shadow.is_empty() && !batches.bounce.is_empty());
            for kind in RayKind::ALL {
                let rays = batches.get(kind);
                let verdict = if kind.is_any_hit() {
                    let (mut a, mut b) = (vec![false; rays.len()], vec![false; rays.len()]);
                    embree.any(rays, &mut a);
                    ours.any(rays, &mut b);
                    compare_any(&scene.mesh, rays, &a, &b, witness(&[embree, &ours]))
                } else {
                    let (mut a, mut b) = (vec![Hit::MISS; rays.len()], vec![Hit::MISS; rays.len()]);
                    embree.closest(rays, &mut a);
                    ours.closest(rays, &mut b);
                    compare_closest(&scene.mesh, rays, &a, &b)
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
