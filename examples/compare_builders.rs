//! Compares two builders on one scene: build time, SAH cost, work per ray; and their hits, which must agree.
//! `cargo run --release --no-default-features --example compare_builders -- lbvh phr-quality`

use phr::bvh::{Bvh4, sah_cost};
use phr::geometry::Hit;
use phr::trace::{BvhTracer, Camera, closest_in_parallel};
use phr::{builders, scene};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut names: Vec<String> = std::env::args().skip(1).collect();
    if names.len() != 2 {
        names = vec!["lbvh".into(), "phr-quality".into()];
    }
    let scene = scene::generator("city").ok_or("no scene is called city")?.generate();
    let camera = Camera::new(&scene.views[0], 256, 256);
    let rays: Vec<_> = (0..1 << 16).map(|i| camera.ray(i % 256, i / 256, [0.5; 2])).collect();

    let mut distances = Vec::new();
    for name in &names {
        let known = || format!("no builder is called {name}; there are {}", builders::NAMES.join(", "));
        let build = builders::by_name::<4>(name).ok_or_else(known)?.build(&scene.mesh);
        let tree: &Bvh4 = &build.tree;
        let tracer = BvhTracer::new(tree);
        let counts = tracer.count_closest(&rays);
        let per_ray = |count: u64| count as f64 / rays.len() as f64;
        let (visits, tests) = (per_ray(counts.node_visits), per_ray(counts.block_tests));
        println!("{name}: {:.1?}, SAH cost {:.2}", build.duration(), sah_cost(tree));
        println!("  {visits:.1} node visits and {tests:.1} block tests per ray");
        let mut hits = vec![Hit::MISS; rays.len()];
        closest_in_parallel(&tracer, &rays, &mut hits);
        distances.push(hits.iter().map(|hit| hit.t).collect::<Vec<_>>());
    }
    let differ = distances[0].iter().zip(&distances[1]).filter(|(a, b)| a != b).count();
    println!("{differ} of {} hits differ in distance", rays.len());
    Ok(())
}
