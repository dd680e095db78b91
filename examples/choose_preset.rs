//! Which preset takes least time for build and trace together? More rays pay for a better tree.
//! `cargo run --release --no-default-features --example choose_preset -- hair 20` (scene, million rays)

use phr::geometry::Hit;
use phr::trace::{BvhTracer, PathSettings, RayKind, closest_in_parallel, record};
use phr::{builders, scene};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "rooms".into());
    let millions: f64 = arguments.next().map_or(Ok(10.0), |number| number.parse())?;
    let scene = scene::generator(&name).ok_or("try rooms, statue, hair, city or pipes")?.generate();

    let mut rays = Vec::new();
    println!("{name}, {millions} million rays, ms:");
    for preset in ["lbvh", "phr-turbo", "phr-speed", "phr-quality", "phr-best"] {
        let mut builder = builders::by_name::<4>(preset).ok_or("no such builder")?;
        let cold = builder.build(&scene.mesh).tree; // the first build also waits for memory
        builder.recycle(cold);
        let build = builder.build(&scene.mesh);
        let tracer = BvhTracer::new(&build.tree);
        if rays.is_empty() {
            let settings = PathSettings { width: 256, height: 256, ..PathSettings::default() };
            let recording = record(&tracer, &scene.mesh, &scene.views[0], &settings);
            rays = recording.batches.get(RayKind::Bounce).to_vec();
        }
        let mut hits = vec![Hit::MISS; rays.len()];
        let start = Instant::now();
        closest_in_parallel(&tracer, &rays, &mut hits);
        let trace = 1e9 * start.elapsed().as_secs_f64() * millions / rays.len() as f64;
        let build = 1e3 * build.duration().as_secs_f64();
        println!("{preset:<12} build {build:6.0}, trace {trace:6.0}, sum {:6.0}", build + trace);
    }
    Ok(())
}
