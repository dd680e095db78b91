//! Generated scenes that move: a body that deforms, one that bursts, and rigid parts among static ones. Triangles
//! keep their vertices, so that trees can be refitted; where they are depends on the time alone.
//!
//! An [`animation`] is one; there are
//!
//! * [`wrung`]: neighbours stay neighbours, a refitted tree ages slowly;
//! * [`burst`]: neighbours part, a refitted tree ages fast;
//! * [`parade`]: rigid parts among static ones.

mod animation;
mod burst;
mod parade;
mod wrung;

pub use animation::{Animated, Animation};

const ALL: [Animated; 3] = [wrung::WRUNG, burst::BURST, parade::PARADE];

/// All scenes that move.
pub fn animated() -> &'static [Animated] {
    &ALL
}

/// The scene that moves called `name`, or `None`.
pub fn animated_by_name(name: &str) -> Option<&'static Animated> {
    ALL.iter().find(|animated| animated.name == name)
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
