//! Rebuilds the tree of an animated mesh in every frame, in the memory of the frame before.
//! `cargo run --release --no-default-features --example rebuild_per_frame`

use phr::geometry::Ray;
use phr::{Bvh, BvhConfig, scene};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut mesh = scene::generator("statue").ok_or("no scene is called statue")?.generate().mesh;
    let still = mesh.vertices().to_vec();
    let mut bvh = Bvh::build(&mesh, &BvhConfig::new("phr-turbo", 8))?;
    // A pool of your own, if not all processors are to be used.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    let down = Ray::new([0.0, 2.0, 0.0], [0.0, -1.0, 0.0]);

    for frame in 0..10 {
        let phase = 0.2 * frame as f32;
        let wave = |&[x, y, z]: &[f32; 3]| [x + 0.05 * (8.0 * y + phase).sin(), y, z];
        mesh.move_vertices(&still.iter().map(wave).collect::<Vec<_>>())?;

        // The tree of the last frame is needed no more: the next one is built where it lay.
        let start = Instant::now();
        pool.install(|| bvh.rebuild(&mesh))?;
        let duration = start.elapsed();
        let hit = bvh.intersect(&down).ok_or("the statue is not below")?;
        println!("frame {frame}: {duration:.1?}, the ray hits at {:.3}", hit.t);
    }
    Ok(())
}
