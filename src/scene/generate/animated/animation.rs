//! A scene that moves: its mesh at rest, and where each vertex is when.

use super::super::parts::Draft;
use crate::geometry::Mesh;
use crate::scene::model::Scene;
use crate::scene::views::View;
use glam::Vec3;
use rayon::prelude::*;

/// Where a vertex is at a time from 0 to 1, by its index and its place at rest.
type Motion = Box<dyn Fn(usize, Vec3, f32) -> Vec3 + Send + Sync>;

/// A scene that moves.
pub struct Animation {
    /// As it is at time 0.
    pub scene: Scene,
    /// The first so many triangles never move.
    pub fixed: usize,
    rest: Vec<[f32; 3]>,
    motion: Motion,
}

/// A generator of scenes that move.
#[derive(Clone, Copy, Debug)]
pub struct Animated {
    /// The scene's name in commands and records.
    pub name: &'static str,
    /// How many triangles it has unless another number is asked for.
    pub triangles: usize,
    /// What is seen, in a line.
    pub about: &'static str,
    /// Names the random choices.
    pub(super) seed: u64,
    pub(super) make: fn(&Animated, usize) -> Animation,
}

impl Animated {
    /// Fewest triangles of one.
    pub const LEAST: usize = 1000;

    /// Makes the scene of exactly so many triangles, [`Animated::LEAST`] to [`Mesh::MAX_TRIANGLES`]; numbers beyond are
    /// taken for the nearest of these.
    pub fn generate(&self, triangles: usize) -> Animation {
        (self.make)(self, triangles.clamp(Self::LEAST, Mesh::MAX_TRIANGLES))
    }

    pub(super) fn animation(&self, draft: Draft, fixed: usize, views: &[View], motion: Motion) -> Animation {
        let rest = draft.vertices;
        let (mesh, dropped) = Mesh::new(at(&rest, &motion, 0.0), draft.triangles)
            .expect("no generator makes more triangles than a mesh may have");
        let source = format!("generated, seed {}", self.seed);
        let scene = Scene::new(self.name.into(), mesh, dropped, views.to_vec(), source);
        Animation { scene, fixed, rest, motion }
    }
}

impl Animation {
    /// Whether more than a floor never moves: a tenth of the triangles.
    pub fn has_static_part(&self) -> bool {
        10 * self.fixed > self.scene.mesh.len()
    }

    /// The vertices at `time`, 0 to 1, in parallel on the current rayon pool; the same at any number of threads.
    pub fn vertices(&self, time: f32) -> Vec<[f32; 3]> {
        at(&self.rest, &self.motion, time)
    }
}

/// Where vertices are that `rest` at those places.
fn at(rest: &[[f32; 3]], motion: &Motion, time: f32) -> Vec<[f32; 3]> {
    let at = |(i, rest): (usize, &[f32; 3])| motion(i, Vec3::from_array(*rest), time).to_array();
    rest.par_iter().enumerate().with_min_len(1 << 12).map(at).collect()
}

/// Appends `more` to `draft`.
pub(super) fn append(draft: &mut Draft, more: Draft) {
    let first = draft.vertices.len() as u32;
    draft.vertices.extend(more.vertices);
    draft.triangles.extend(more.triangles.into_iter().map(|triangle| triangle.map(|i| first + i)));
}

/// A square of two triangles in the xz plane, as wide as `size`, around the origin.
pub(super) fn floor(size: f32) -> Draft {
    let h = 0.5 * size;
    Draft {
        vertices: vec![[-h, 0.0, -h], [h, 0.0, -h], [h, 0.0, h], [-h, 0.0, h]],
        triangles: vec![[0, 2, 1], [0, 3, 2]],
    }
}
