//! Rebuilds the tree of an animated mesh in every frame, in the memory of the frame before.
//! `cargo run --release --no-default-features --example rebuild_per_frame`

use phr::geometry::Ray;
use phr::{Bvh, builders, scene};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut mesh = scene::generator("statue").ok_or("no scene is called statue")?.generate().mesh;
    let still = mesh.vertices().to_vec();
    let mut builder = builders::by_name::<8>("phr-turbo").ok_or("no builder is called phr-turbo")?;
    // A pool of your own, if not all processors are to be used.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    let down =
        Ray { org: [0.0, 2.0, 0.0].into(), tnear: 0.0, dir: [0.0, -1.0, 0.0].into(), tfar: f32::INFINITY };

    let mut last: Option<Bvh> = None;
    for frame in 0..10 {
        let phase = 0.2 * frame as f32;
        let wave = |&[x, y, z]: &[f32; 3]| [x + 0.05 * (8.0 * y + phase).sin(), y, z];
        mesh.move_vertices(&still.iter().map(wave).collect::<Vec<_>>())?;

        // The tree of the last frame is needed no more: the next one is built where it lay.
        if let Some(tree) = last.take().and_then(Bvh::into_bvh8) {
            builder.recycle(tree);
        }
        let build = pool.install(|| builder.build(&mesh));
        let duration = build.duration();
        let bvh = pool.install(|| Bvh::try_from(build.tree))?;
        let hit = bvh.intersect(&down).ok_or("the statue is not below")?;
        println!("frame {frame}: {duration:.1?}, the ray hits at {:.3}", hit.t);
        last = Some(bvh);
    }
    Ok(())
}
