//! Builds a tree over a generated room and traces the rays of a camera through it, all at once and one by one.
//! `cargo run --release --no-default-features --example build_and_trace`

use phr::trace::Camera;
use phr::{Bvh, BvhConfig, scene};
use std::error::Error;
use std::time::Instant;

/// Pixels across and down.
const SIZE: u32 = 512;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = scene::generator("rooms").ok_or("no scene is called rooms")?.generate();
    let start = Instant::now();
    let bvh = Bvh::build(&scene.mesh, &BvhConfig::default())?;
    println!("{} triangles in {:.1?}, {} bytes", scene.mesh.len(), start.elapsed(), bvh.bytes());

    let camera = Camera::new(&scene.views[0], SIZE, SIZE);
    let rays: Vec<_> = (0..SIZE * SIZE).map(|i| camera.ray(i % SIZE, i / SIZE, [0.5; 2])).collect();
    let mut hits = vec![None; rays.len()];
    let start = Instant::now();
    bvh.intersect_batch(&rays, &mut hits);
    println!("{} rays in {:.1?}, one thread", rays.len(), start.elapsed());
    println!("{} hit a triangle", hits.iter().flatten().count());

    let centre = bvh.intersect(&camera.ray(SIZE / 2, SIZE / 2, [0.5; 2])).ok_or("nothing is there")?;
    let facing = centre.normal.normalize();
    println!("in the middle: triangle {} at distance {:.2}, facing {facing:.2}", centre.prim, centre.t);
    Ok(())
}
