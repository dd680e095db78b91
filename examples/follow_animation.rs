//! Three ways to follow a mesh that moves: build again, refit the tree, refine it again from a refitted auxiliary tree.
//! `cargo run --release --no-default-features --example follow_animation -- parade` (wrung, burst, parade)

use phr::builders::{Builder, Phr, PhrConfig};
use phr::bvh::sah_cost;
use phr::scene;
use std::error::Error;
use std::time::Instant;

const FRAMES: usize = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "parade".into());
    let moving = scene::animated_by_name(&name).ok_or("try wrung, burst or parade")?;
    let animation = moving.generate(moving.triangles);
    let mut mesh = animation.scene.mesh.clone();

    let mut rebuilding = Phr::<8>::new("phr-fast", PhrConfig::FAST)?;
    let mut refining = Phr::<8>::new("phr-fast", PhrConfig::FAST)?;
    let mut refitted = rebuilding.build(&mesh).tree;
    let mut last = refining.build(&mesh).tree;
    println!("{name}, SAH cost (and milliseconds) of trees rebuilt, refitted, refined again:");
    for frame in 1..FRAMES {
        mesh.move_vertices(&animation.vertices(frame as f32 / (FRAMES - 1) as f32))?;
        let start = Instant::now();
        let rebuilt = rebuilding.build(&mesh).tree;
        let rebuild = start.elapsed();
        refitted.refit(&mesh)?;
        let refit = start.elapsed() - rebuild;
        refining.recycle(last);
        last = refining.refit(&mesh)?.tree;
        let refine = start.elapsed() - rebuild - refit;
        let told = [(&rebuilt, rebuild), (&refitted, refit), (&last, refine)];
        let told =
            told.map(|(tree, time)| format!("{:.2} ({:.1})", sah_cost(tree), 1e3 * time.as_secs_f64()));
        println!("frame {frame}: {}", told.join(", "));
        rebuilding.recycle(rebuilt);
    }
    Ok(())
}
