//! Builds a tree over a generated room and traces the rays of a camera through it.
//! `cargo run --release --example build_and_trace`

use phr::bvh::Statistics;
use phr::geometry::Hit;
use phr::trace::{BvhTracer, Camera, closest_in_parallel};
use phr::{builders, scene};
use std::error::Error;

/// Pixels across and down.
const SIZE: u32 = 512;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = scene::generator("rooms").ok_or("no scene is called rooms")?.generate();
    let mut builder = builders::by_name::<4>("phr-speed").ok_or("no builder is called phr-speed")?;
    let build = builder.build(&scene.mesh);
    println!("{} triangles in {:.1?}:", scene.mesh.len(), build.duration());
    for phase in &build.phases {
        println!("  {:<16} {:.1?}", phase.name, phase.duration);
    }
    let Statistics { sah, nodes, leaves, bytes, .. } = Statistics::of(&build.tree, &scene.mesh);
    println!("SAH cost {sah:.2}, {nodes} inner nodes, {leaves} leaves, {bytes} bytes");

    let camera = Camera::new(&scene.views[0], SIZE, SIZE);
    let rays: Vec<_> = (0..SIZE * SIZE).map(|i| camera.ray(i % SIZE, i / SIZE, [0.5; 2])).collect();
    let mut hits = vec![Hit::MISS; rays.len()];
    closest_in_parallel(&BvhTracer::new(&build.tree), &rays, &mut hits);
    println!("{} of {} rays hit a triangle", hits.iter().filter(|hit| hit.is_hit()).count(), rays.len());
    Ok(())
}
