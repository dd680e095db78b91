//! `views.json` beside a scene: cameras that can be used, or a refusal in one line.

use phr::scene::{Limits, load_within};
use phr::trace::Camera;
use std::cell::OnceCell;

/// The machine's own would be asked for each time.
const LIMITS: Limits = Limits { memory: 1 << 26 };

thread_local! {
    static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() };
}

/// Whether the cameras can be used.
pub fn check(data: &[u8]) -> bool {
    FOLDER.with(|folder| {
        let folder = folder.get_or_init(|| {
            let folder = tempfile::tempdir().unwrap();
            std::fs::write(folder.path().join("x.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
            folder
        });
        std::fs::write(folder.path().join("views.json"), data).unwrap();
        match load_within(folder.path().join("x.obj"), &LIMITS) {
            Ok(scene) => {
                assert!(!scene.remarks().concat().contains(char::is_control), "{:?}", scene.remarks());
                for view in &scene.views {
                    let ray = Camera::new(view, 8, 8).ray(3, 5, [0.5; 2]);
                    assert!(ray.org.is_finite() && ray.dir.is_finite(), "{view:?}");
                }
                true
            }
            Err(error) => {
                assert!(!error.to_string().contains(char::is_control), "{error}");
                false
            }
        }
    })
}
