//! The generated scenes by name: the built-in set and the stand-ins for the paper's nine.

use super::generated_scene::Generator;
use super::{ancient, city, conference, courtyard, crown, hair, interior, plant, statue};

/// The small set that `make bench` and the tests use.
const BUILTIN: [Generator; 5] = [interior::ROOMS, statue::STATUE, hair::HAIRBALL, city::CITY, plant::PIPES];

/// The small set for a first benchmark and the tests: an interior, a scanned surface, a hair ball, a city and
/// a maze of pipes.
pub fn builtin() -> &'static [Generator] {
    &BUILTIN
}

/// The nine stand-ins for the paper's scenes, in the paper's order.
const STAND_INS: [Generator; 9] = [
    conference::CONFERENCE,
    statue::BUDDHA,
    interior::OFFICES,
    hair::HAIRBALL_FULL,
    crown::CROWN,
    ancient::ANCIENT,
    courtyard::COURTYARD,
    city::VIENNA,
    plant::POWER_PLANT,
];

/// All generators: the built-in set, then the stand-ins for the paper's scenes.
pub fn generators() -> impl Iterator<Item = &'static Generator> {
    BUILTIN.iter().chain(&STAND_INS)
}

/// The generator called `name`, or `None`.
pub fn generator(name: &str) -> Option<&'static Generator> {
    generators().find(|g| g.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::parts::count;
    use crate::scene::generate::{scalable, scalable_name, scalable_triangles};

    #[test]
    fn builtin_scenes_repeat_and_keep_their_word() {
        for generator in builtin() {
            let scene = generator.generate();
            assert_eq!(scene.mesh.len(), generator.triangles, "{}", generator.name);
            assert_eq!(scene.dropped.total(), 0);
            let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            assert_eq!(one_thread.install(|| generator.generate()).sha, scene.sha, "{}", generator.name);
        }
    }

    #[test]
    fn every_camera_sees_a_picture() {
        for generator in generators() {
            assert_eq!(generator.views.len(), 3, "{}", generator.name);
            for view in generator.views {
                assert_eq!(view.check(), Ok(()), "{}: {view:?}", generator.name);
            }
        }
    }

    #[test]
    fn names_are_unique_and_stand_ins_say_so() {
        let names: Vec<_> = generators().map(|g| g.name).collect();
        assert_eq!(names.len(), 14);
        for (i, name) in names.iter().enumerate() {
            assert!(!names[..i].contains(name), "{name}");
            assert_eq!(i >= builtin().len(), name.ends_with("-like"), "{name}");
            assert_eq!(generator(name).map(|g| g.name), Some(*name));
        }
        assert!(generator("no such scene").is_none());
    }

    /// Counts only: the rest comes from halving triangles, which the layout's tests prove exact.
    #[test]
    fn layouts_come_close_to_their_size() {
        for generator in generators() {
            let counted = count(generator.triangles, generator.seed, &generator.layout);
            let share = counted as f64 / generator.triangles as f64;
            assert!((0.9..=1.0).contains(&share), "{}: {counted}", generator.name);
        }
    }

    #[test]
    fn scenes_of_any_size_have_that_size() {
        for triangles in [0, 1, 2, 5, 6, 7, 100, 5_000, 60_001, 250_000] {
            let scene = scalable(triangles, 7);
            assert_eq!(scene.mesh.len(), triangles);
            assert!(scene.views.iter().all(|view| view.check().is_ok()));
        }
        assert_eq!(scalable(5_000, 7).name, "scalable-5k");
        assert_ne!(scalable(10_000, 1).sha, scalable(10_000, 2).sha);
        assert_eq!(scalable(10_000, 1).sha, scalable(10_000, 1).sha);
    }

    #[test]
    fn scenes_of_any_size_go_by_their_size() {
        for (triangles, name) in [
            (1, "scalable-1"),
            (1500, "scalable-1500"),
            (64_000, "scalable-64k"),
            (32_000_000, "scalable-32M"),
        ] {
            assert_eq!(scalable_name(triangles), name);
            assert_eq!(scalable_triangles(name), Some(triangles));
        }
        assert_eq!(scalable_triangles("scalable-1000k"), Some(1_000_000));
        let wrong = [
            "scalable-",
            "scalable-0",
            "scalable-M",
            "scalable-1.5M",
            "scalable-+1M",
            "scalable-1m",
            "rooms",
        ];
        assert!(wrong.iter().all(|name| scalable_triangles(name).is_none()));
        assert_eq!(scalable_triangles("scalable-269M"), None, "more than a mesh may have");
    }
}
