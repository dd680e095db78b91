//! Scene files of every format, plain or compressed: read whole or refused in one line. The first byte chooses the
//! format.

use phr::scene::{Limits, load_within};
use std::cell::OnceCell;

const FORMATS: [&str; 8] = ["obj", "ply", "stl", "gltf", "glb", "obj.gz", "ply.zst", "ply.gz"];
const LIMITS: Limits = Limits { memory: 1 << 26 };

thread_local! {
    static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() };
}

/// Whether the file was read.
pub fn check(data: &[u8]) -> bool {
    let Some((first, content)) = data.split_first() else { return false };
    FOLDER.with(|folder| {
        let folder = folder.get_or_init(|| tempfile::tempdir().unwrap());
        let path = folder.path().join(format!("x.{}", FORMATS[*first as usize % FORMATS.len()]));
        std::fs::write(&path, content).unwrap();
        match load_within(&path, &LIMITS) {
            Ok(scene) => {
                assert!(!scene.remarks().concat().contains(char::is_control), "{:?}", scene.remarks());
                assert!(!scene.mesh.is_empty() && !scene.views.is_empty());
                let bounds = scene.mesh.bounds();
                assert!(bounds.min.is_finite() && bounds.max.is_finite());
                true
            }
            Err(error) => {
                assert!(!error.to_string().contains(char::is_control), "{error}");
                false
            }
        }
    })
}
