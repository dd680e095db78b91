//! A generated scene: its name, size, layout and cameras.

use super::parts::{Layout, draw};
use crate::geometry::Mesh;
use crate::scene::model::Scene;
use crate::scene::views::View;
use glam::Vec3;

/// A scene that is made, not loaded.
#[derive(Clone, Copy, Debug)]
pub struct Generator {
    /// The scene's name in commands and records.
    pub name: &'static str,
    /// Exactly how many triangles it has.
    pub triangles: usize,
    /// What is seen, in a line.
    pub about: &'static str,
    /// Names the random choices.
    pub(super) seed: u64,
    /// Adds the scene's parts.
    pub(super) layout: fn(&mut Layout),
    /// The cameras.
    pub(super) views: &'static [View],
}

impl Generator {
    /// Makes the scene, in parallel on the current rayon pool; the same at any number of threads.
    pub fn generate(&self) -> Scene {
        let draft = draw(self.triangles, self.seed, &self.layout);
        let (mesh, dropped) = Mesh::new(draft.vertices, draft.triangles)
            .expect("no generator makes more triangles than a mesh may have");
        let source = format!("generated, seed {}", self.seed);
        Scene::new(self.name.to_owned(), mesh, dropped, self.views.to_vec(), source)
    }
}

/// A camera with Y up.
pub(super) const fn view(eye: [f32; 3], target: [f32; 3], fov_y_deg: f32) -> View {
    View { eye: Vec3::from_array(eye), target: Vec3::from_array(target), up: Vec3::Y, fov_y_deg }
}
