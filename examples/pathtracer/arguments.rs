//! The command line.

use phr::glam::Vec3;
use phr::scene::{Scene, View};
use std::path::PathBuf;

/// Render a scene file to a PNG
#[derive(clap::Parser)]
pub struct Arguments {
    /// Scene: .gltf, .glb, .obj, .ply or .stl, also with .gz or .zst
    pub scene: PathBuf,
    /// PNG file to write
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Pixels across
    #[arg(long, default_value_t = 960, value_parser = clap::value_parser!(u32).range(1..=16384))]
    width: u32,
    /// Pixels down
    #[arg(long, default_value_t = 540, value_parser = clap::value_parser!(u32).range(1..=16384))]
    height: u32,
    /// Paths per pixel
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub samples: u32,
    /// Most bounces of a path
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(0..=64))]
    pub bounces: u32,
    /// Builder of the tree
    #[arg(long, default_value = "phr-quality")]
    pub builder: String,
    /// View of the scene, from 0: those of views.json beside it, else three around it
    #[arg(long, default_value_t = 0, value_name = "K")]
    view: usize,
    /// Where the camera stands, as X,Y,Z
    #[arg(long, value_parser = point, value_name = "X,Y,Z", allow_hyphen_values = true)]
    eye: Option<Vec3>,
    /// What it looks at
    #[arg(long, value_parser = point, value_name = "X,Y,Z", allow_hyphen_values = true)]
    target: Option<Vec3>,
}

impl Arguments {
    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Refuses a place that cannot be written before hours are spent on the picture.
    pub fn check_output(&self) -> Result<(), String> {
        let folder = self.output.parent().filter(|folder| !folder.as_os_str().is_empty());
        match folder {
            Some(folder) if !folder.is_dir() => {
                Err(format!("{}: no such folder; make it first", folder.display()))
            }
            _ => Ok(()),
        }
    }

    /// The view asked for.
    pub fn view(&self, scene: &Scene) -> Result<View, String> {
        let count = scene.views.len();
        let known = scene.views.get(self.view);
        let view =
            known.ok_or_else(|| format!("--view {}: {} has {count}, from 0", self.view, scene.name))?;
        let view =
            View { eye: self.eye.unwrap_or(view.eye), target: self.target.unwrap_or(view.target), ..*view };
        view.check().map_err(|why| format!("--eye, --target: {why}"))?;
        Ok(view)
    }
}

fn point(text: &str) -> Result<Vec3, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z]) => Ok(Vec3::new(x, y, z)),
        _ => Err("give three numbers, as 1,2.5,-3".into()),
    }
}
