//! Generated scenes that move: a body that deforms, one that bursts, and rigid parts among static ones. Triangles keep their
//! vertices, so that trees can be refitted; where they are depends on the time alone.
//!
//! * [`wrung`]: neighbours stay neighbours, a refitted tree ages slowly;
//! * [`burst`]: neighbours part, a refitted tree ages fast;
//! * [`parade`]: rigid parts among static ones.

mod burst;
mod parade;
mod wrung;

use super::parts::Draft;
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
    seed: u64,
    make: fn(&Animated, usize) -> Animation,
}

const ALL: [Animated; 3] = [wrung::WRUNG, burst::BURST, parade::PARADE];

/// All scenes that move.
pub fn animated() -> &'static [Animated] {
    &ALL
}

/// The scene that moves called `name`, or `None`.
pub fn animated_by_name(name: &str) -> Option<&'static Animated> {
    ALL.iter().find(|animated| animated.name == name)
}

impl Animated {
    /// Fewest triangles of one.
    pub const LEAST: usize = 1000;

    /// Makes the scene of exactly so many triangles, [`Animated::LEAST`] to [`Mesh::MAX_TRIANGLES`]; numbers beyond are
    /// taken for the nearest of these.
    pub fn generate(&self, triangles: usize) -> Animation {
        (self.make)(self, triangles.clamp(Self::LEAST, Mesh::MAX_TRIANGLES))
    }

    fn animation(&self, draft: Draft, fixed: usize, views: &[View], motion: Motion) -> Animation {
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
fn append(draft: &mut Draft, more: Draft) {
    let first = draft.vertices.len() as u32;
    draft.vertices.extend(more.vertices);
    draft.triangles.extend(more.triangles.into_iter().map(|triangle| triangle.map(|i| first + i)));
}

/// A square of two triangles in the xz plane, as wide as `size`, around the origin.
fn floor(size: f32) -> Draft {
    let h = 0.5 * size;
    Draft {
        vertices: vec![[-h, 0.0, -h], [h, 0.0, -h], [h, 0.0, h], [-h, 0.0, h]],
        triangles: vec![[0, 2, 1], [0, 3, 2]],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_move_as_they_say() {
        for animated in animated() {
            let animation = animated.generate(6000);
            let (scene, fixed) = (&animation.scene, animation.fixed);
            assert_eq!((scene.mesh.len(), scene.dropped.total()), (6000, 0), "{}", animated.name);
            assert!(scene.views.iter().all(|view| view.check().is_ok()));
            assert_eq!(animation.vertices(0.0), scene.mesh.vertices());
            let later = animation.vertices(0.6);
            let moved = |triangle: &[u32; 3]| {
                triangle.iter().any(|&i| later[i as usize] != scene.mesh.vertices()[i as usize])
            };
            let (still, moving) = scene.mesh.triangles().split_at(fixed);
            assert!(!still.iter().any(moved), "{}", animated.name);
            let count = moving.iter().filter(|triangle| moved(triangle)).count();
            assert!(count > moving.len() * 9 / 10, "{}: {count} of {}", animated.name, moving.len());
            let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            assert_eq!(one_thread.install(|| animated.generate(6000).vertices(0.6)), later);
            for time in [0.25, 1.0] {
                let mut mesh = scene.mesh.clone();
                mesh.move_vertices(&animation.vertices(time)).unwrap();
            }
        }
        assert!(animated_by_name("parade").is_some() && animated_by_name("rooms").is_none());
    }

    #[test]
    fn sizes_are_kept_to() {
        for animated in animated() {
            for (asked, made) in [(0, 1000), (1001, 1001), (40_000, 40_000)] {
                assert_eq!(animated.generate(asked).scene.mesh.len(), made, "{}", animated.name);
            }
        }
    }
}
