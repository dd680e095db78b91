//! What fuzzing checks, of its seeds (but those of rays, one of which is written out) and of some inputs made here: so that
//! the checks compile, and the seeds stay what they are to be.

#[path = "../../fuzz/src/configuration.rs"]
mod configuration;
#[path = "../../fuzz/src/rays.rs"]
mod rays;
#[path = "../../fuzz/src/results.rs"]
mod results;
#[path = "../../fuzz/src/saved_tree.rs"]
mod saved_tree;
#[path = "../../fuzz/src/scene_file.rs"]
mod scene_file;
#[path = "../../fuzz/src/views.rs"]
mod views;

use phr::geometry::Ray;
use phr::random::SplitMix64;
use std::path::PathBuf;

/// The seeds of a target, with their names.
fn seeds(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = [env!("CARGO_MANIFEST_DIR"), "fuzz/seeds", target].iter().collect::<PathBuf>();
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.map(|path| (path.clone(), std::fs::read(path).unwrap())).collect()
}

/// A file with one byte changed may be anything, but nothing that panics.
fn all_are_read(target: &str, count: usize, check: fn(&[u8]) -> bool) {
    let seeds = seeds(target);
    assert!(seeds.len() >= count, "{} seeds of {target}", seeds.len());
    let mut random = SplitMix64::new(1);
    for (path, seed) in seeds {
        assert!(check(&seed), "{} is refused", path.display());
        for _ in 0..20 {
            let mut changed = seed.clone();
            changed[1 + random.below(seed.len() - 1)] = random.below(256) as u8;
            check(&changed);
        }
    }
}

#[test]
fn seeds_are_read_whole() {
    all_are_read("results", 19, results::check);
    all_are_read("scene_file", 10, scene_file::check);
    all_are_read("views", 1, views::check);
}

#[test]
fn a_tree_is_read_unless_it_is_changed_or_cut() {
    assert!(saved_tree::check(None, &[]));
    assert!(!saved_tree::check(Some(200), &[]) && !saved_tree::check(None, &[(0, 1)]));
}

#[test]
fn configurations_and_rays_pass() {
    let mut random = SplitMix64::new(2);
    let mut vector = |size: f32| [0; 3].map(|_| random.range(-size, size));
    let vertices: Vec<[f32; 3]> = (0..30).map(|_| vector(10.0)).collect();
    let triangles: Vec<[u8; 3]> = (0..28).map(|i| [i, i + 1, i + 2]).collect();
    let any =
        |builder: u8, changes: &str| configuration::check(builder, changes, vertices.clone(), &triangles);
    assert!((0..8).all(|builder| any(builder, "")) && !any(0, "nothing=3"));
    let ray = |(org, dir): ([f32; 3], [f32; 3])| Ray {
        org: org.into(),
        tnear: 0.0,
        dir: dir.into(),
        tfar: f32::INFINITY,
    };
    let moderate: Vec<Ray> = (0..500).map(|_| (vector(100.0), vector(1.0))).map(ray).collect();
    rays::check(moderate);
    // From so far away all distances are equal up to rounding.
    let far = Ray {
        org: [0.0, 6.5392e-41, -34_360_720_000.0].into(),
        tnear: 3.009_317_2e-36,
        dir: [0.0, 1.6143e-41, 525_459.5].into(),
        tfar: 824_467.56,
    };
    rays::check(vec![far; 8]);
    rays::check((0..100).map(|_| (vector(1e18), vector(1e-30))).map(ray).collect());
}
