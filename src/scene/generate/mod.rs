//! Generated scenes: seeded, the same on every platform, with an exact number of triangles.

mod city;
mod frame;
mod furniture;
mod hair;
mod interior;
mod layout;
mod part;
mod plant;
mod random;
mod statue;

use super::{Scene, View};
use crate::geometry::Mesh;
use glam::Vec3;
use layout::Layout;

/// A scene that is made, not loaded.
#[derive(Clone, Copy, Debug)]
pub struct Generator {
    /// The scene's name in commands and records.
    pub name: &'static str,
    /// Exactly how many triangles it has.
    pub triangles: usize,
    /// What is seen, in a line.
    pub about: &'static str,
    seed: u64,
    layout: fn(&mut Layout),
    views: &'static [View],
}

impl Generator {
    /// Makes the scene, in parallel on the current rayon pool; the same at any number of threads.
    pub fn generate(&self) -> Scene {
        let draft = layout::draw(self.triangles, self.seed, &self.layout);
        let (mesh, dropped) = Mesh::new(draft.vertices, draft.triangles)
            .expect("no generator makes more triangles than a mesh may have");
        let source = format!("generated, seed {}", self.seed);
        Scene::new(self.name.to_owned(), mesh, dropped, self.views.to_vec(), source)
    }
}

/// A camera with Y up.
const fn view(eye: [f32; 3], target: [f32; 3], fov_y_deg: f32) -> View {
    View { eye: Vec3::from_array(eye), target: Vec3::from_array(target), up: Vec3::Y, fov_y_deg }
}

/// The small set that `make bench` and the tests use.
const BUILTIN: [Generator; 5] = [interior::ROOMS, statue::STATUE, hair::HAIRBALL, city::CITY, plant::PIPES];

/// The small set for a first benchmark and the tests: an interior, a scanned surface, a hair ball, a city and
/// a maze of pipes.
pub fn builtin() -> &'static [Generator] {
    &BUILTIN
}

/// The generator called `name`, or `None`.
pub fn generator(name: &str) -> Option<&'static Generator> {
    builtin().iter().find(|g| g.name == name)
}
