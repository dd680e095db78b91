//! A small path tracer over a scene of yours, without a window: glTF, GLB, OBJ, PLY or STL in, PNG out.
//! `cargo run --release --no-default-features --features harness --example pathtracer -- scene.glb -o out.png`

mod arguments;
mod camera;
mod light;
mod paths;
mod picture;

use arguments::Arguments;
use camera::Camera;
use clap::Parser as _;
use indicatif::{ProgressBar, ProgressStyle};
use light::Light;
use paths::PathTracer;
use phr::{Bvh, BvhConfig, scene};
use picture::Picture;
use rayon::prelude::*;
use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("pathtracer: {why}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    arguments.check_output()?;
    let scene = scene::load(&arguments.scene)?;
    let start = Instant::now();
    let bvh = Bvh::build(&scene.mesh, &BvhConfig { builder: &arguments.builder, ..BvhConfig::default() })?;
    eprintln!("{} triangles, tree in {:.1?}", scene.mesh.len(), start.elapsed());

    let [width, height] = arguments.size();
    let view = arguments.view(&scene)?;
    let camera = Camera::new(&view, width, height);
    let tracer = PathTracer { bvh: &bvh, light: Light::over(&view), bounces: arguments.bounces };
    let mut picture = Picture::new(width, height);

    let bar = ProgressBar::new(u64::from(height))
        .with_style(ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed} gone, {eta} to go")?);
    let start = Instant::now();
    picture.rows().enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = tracer.pixel(&camera, [x as u32, y as u32], arguments.samples);
        }
        bar.inc(1);
    });
    bar.finish_and_clear();
    picture.write(&arguments.output)?;
    eprintln!("{} in {:.1?}", arguments.output.display(), start.elapsed());
    Ok(())
}
