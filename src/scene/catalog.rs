//! The nine scenes of the paper's Table 1, with their usual file names and their generated stand-ins.
//!
//! The paper prints no camera positions. The originals therefore get the cameras of a `views.json` in their
//! folder, or those placed around the geometry; stand-ins have cameras of their own.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]

use super::generate::{Generator, generator};
use std::path::{Path, PathBuf};

/// A scene of the paper's Table 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PaperScene {
    /// As the paper writes it.
    pub name: &'static str,
    /// As the paper states it, in thousands; copies in circulation differ somewhat.
    pub triangles: usize,
    /// Stems of the files under which it is usually distributed, in lower case.
    pub file_names: &'static [&'static str],
    /// The generator of the same character and number of triangles.
    pub stand_in: &'static str,
}

impl PaperScene {
    /// The generated scene of the same character and number of triangles. It is not the original.
    pub fn stand_in(&self) -> Option<&'static Generator> {
        generator(self.stand_in)
    }
}

const PAPER: [PaperScene; 9] = [
    PaperScene {
        name: "Conference",
        triangles: 331_000,
        file_names: &["conference", "conference_room", "conf"],
        stand_in: "conference-like",
    },
    PaperScene {
        name: "Happy Buddha",
        triangles: 1_087_000,
        file_names: &["happy_vrip", "happy", "buddha", "happy_buddha", "happy-buddha", "happybuddha"],
        stand_in: "buddha-like",
    },
    PaperScene {
        name: "Soda Hall",
        triangles: 2_169_000,
        file_names: &["sodahall", "soda_hall", "soda-hall", "soda"],
        stand_in: "sodahall-like",
    },
    PaperScene {
        name: "Hairball",
        triangles: 2_880_000,
        file_names: &["hairball", "hair_ball"],
        stand_in: "hairball-like",
    },
    PaperScene {
        name: "Crown",
        triangles: 4_868_000,
        file_names: &["crown", "imperial_crown", "imperial_crown_of_austria"],
        stand_in: "crown-like",
    },
    PaperScene {
        name: "Pompeii",
        triangles: 5_632_000,
        file_names: &["pompeii", "pompei"],
        stand_in: "pompeii-like",
    },
    PaperScene {
        name: "San Miguel",
        triangles: 7_880_000,
        file_names: &["san-miguel", "sanmiguel", "san_miguel", "sanmiguel20"],
        stand_in: "sanmiguel-like",
    },
    PaperScene { name: "Vienna", triangles: 8_637_000, file_names: &["vienna"], stand_in: "vienna-like" },
    PaperScene {
        name: "Power Plant",
        triangles: 12_759_000,
        file_names: &["powerplant", "power_plant", "power-plant"],
        stand_in: "powerplant-like",
    },
];

/// File extensions of scenes, the preferred first, each also with those of compression.
const ENDINGS: [&str; 5] = [".ply", ".obj", ".glb", ".gltf", ".stl"];
const COMPRESSED: [&str; 3] = ["", ".zst", ".gz"];

/// The nine scenes, in the paper's order.
pub fn paper() -> &'static [PaperScene] {
    &PAPER
}

/// The file in `dir` that holds the original of `scene`, by its name in any case of letters; the first in the
/// order of [`PaperScene::file_names`] where there are several. `None` too if `dir` cannot be read.
pub fn paper_scene_in(dir: &Path, scene: &PaperScene) -> Option<PathBuf> {
    let entries = std::fs::read_dir(dir).ok()?.filter_map(Result::ok);
    let rank = |path: &Path| {
        let name = path.file_name()?.to_str()?.to_ascii_lowercase();
        scene.file_names.iter().enumerate().find_map(|(i, stem)| {
            let ending = name.strip_prefix(stem)?;
            let after = |(i, format)| Some((i, ending.strip_prefix(format)?));
            let (format, after) = ENDINGS.into_iter().enumerate().find_map(after)?;
            let compression = COMPRESSED.iter().position(|end| *end == after)?;
            Some((i, format, compression))
        })
    };
    entries
        .map(|entry| entry.path())
        .filter(|path| path.is_file())
        .filter_map(|path| Some((rank(&path)?, path)))
        .min()
        .map(|(_, path)| path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_has_a_stand_in_of_its_size() {
        assert_eq!(paper().len(), 9);
        for scene in paper() {
            let stand_in = scene.stand_in().expect(scene.stand_in);
            assert_eq!(stand_in.triangles, scene.triangles, "{}", scene.name);
            assert!(stand_in.name.ends_with("-like"));
            assert!(scene.file_names.iter().all(|n| *n == n.to_lowercase() && !n.ends_with("-like")));
        }
    }

    #[test]
    fn originals_are_found_by_their_usual_names() {
        let dir = tempfile::tempdir().unwrap();
        let found = |scene: usize| {
            let path = paper_scene_in(dir.path(), &PAPER[scene])?;
            Some(path.file_name()?.to_string_lossy().into_owned())
        };
        assert_eq!(found(0), None);
        for name in ["Conference.OBJ", "happy.ply", "Happy_Vrip.ply.gz", "san-miguel.txt", "crown-like.ply"] {
            std::fs::write(dir.path().join(name), "").unwrap();
        }
        std::fs::create_dir(dir.path().join("vienna.ply")).unwrap();
        assert_eq!(found(0).as_deref(), Some("Conference.OBJ"));
        assert_eq!(found(1).as_deref(), Some("Happy_Vrip.ply.gz"));
        assert_eq!((found(4), found(6), found(7)), (None, None, None));
        assert_eq!(paper_scene_in(Path::new("/no such folder"), &PAPER[0]), None);
    }
}
