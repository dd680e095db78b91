//! A hundred thousand instances of one mesh, all of which move in every frame: the upper tree is rebuilt.
//! `cargo run --release --no-default-features --features files --example instances -- bunny.ply`, or without a file

use phr::glam::{Affine3A, Quat, Vec3};
use phr::random::SplitMix64;
use phr::trace::Camera;
use phr::{Bvh, BvhConfig, Instance, InstanceBvh, scene};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = match std::env::args_os().nth(1) {
        Some(file) => scene::load(file)?,
        None => scene::generator("statue").ok_or("no scene is called statue")?.generate(),
    };
    let object = Bvh::build(&scene.mesh, &BvhConfig::new("phr-quality", 8))?;
    let far = 20.0 * object.bounds().extent().max_element();
    let mut random = SplitMix64::new(1);
    let places: Vec<(Vec3, f32)> = (0..100_000).map(|_| (random.point(-far, far), random.unit())).collect();
    let at = |frame: f32| -> Vec<_> {
        let place = |&(place, speed): &(Vec3, f32)| {
            Affine3A::from_rotation_translation(Quat::from_rotation_y(speed * frame), place)
        };
        places.iter().map(place).map(|transform| Instance { bvh: &object, transform }).collect()
    };
    let config = BvhConfig::new("phr-turbo", 8);
    let mut world = InstanceBvh::build(at(0.0), &config)?;
    println!("{} triangles, {} times", scene.mesh.len(), world.len());
    let camera = Camera::new(&scene.views[0], 256, 256);
    let rays: Vec<_> = (0..1 << 16).map(|i| camera.ray(i % 256, i / 256, [0.5; 2])).collect();
    for frame in 1..=5 {
        let instances = at(frame as f32);
        let start = Instant::now();
        world.rebuild(instances)?;
        let rebuilt = start.elapsed();
        let hits = rays.iter().filter(|ray| world.intersect(ray).is_some()).count();
        let traced = start.elapsed() - rebuilt;
        println!("frame {frame}: rebuilt in {rebuilt:.1?}, {hits} of 65536 rays hit, {traced:.1?}");
    }
    Ok(())
}
