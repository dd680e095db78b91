//! Rebuilds the tree of an animated mesh in every frame, in the memory of the frame before.
//! `cargo run --release --example rebuild_per_frame`

use phr::geometry::{Hit, Mesh, Ray, Tracer};
use phr::trace::BvhTracer;
use phr::{builders, scene};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let still = scene::generator("statue").ok_or("no scene is called statue")?.generate().mesh;
    let mut builder = builders::by_name::<4>("phr-speed").ok_or("no builder is called phr-speed")?;
    // A pool of your own, if not all processors are to be used.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    let down =
        Ray { org: [0.0, 2.0, 0.0].into(), tnear: 0.0, dir: [0.0, -1.0, 0.0].into(), tfar: f32::INFINITY };

    let mut old = None;
    for frame in 0..10 {
        let phase = 0.2 * frame as f32;
        let wave = |[x, y, z]: [f32; 3]| [x + 0.05 * (8.0 * y + phase).sin(), y, z];
        let vertices = still.vertices().iter().copied().map(wave).collect();
        let (mesh, _) = Mesh::new(vertices, still.triangles().to_vec())?;

        // The tree of the last frame is needed no more: the next one is built where it lay.
        if let Some(tree) = old.take() {
            builder.recycle(tree);
        }
        let build = pool.install(|| builder.build(&mesh));
        let mut hit = [Hit::MISS];
        BvhTracer::new(&build.tree).closest(&[down], &mut hit);
        println!("frame {frame}: {:.1?}, the ray hits at {:.3}", build.duration(), hit[0].t);
        old = Some(build.tree);
    }
    Ok(())
}
