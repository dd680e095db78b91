//! The order of the modules: each depends only on those before it.

use std::path::Path;

const ROOMS: [&str; 9] = ["geometry", "scene", "bvh", "build", "embree", "trace", "bench", "report", "cli"];

fn sources(folder: &Path, files: &mut Vec<std::path::PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

#[test]
fn modules_depend_only_on_those_before_them() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut violations = Vec::new();
    for (place, room) in ROOMS.iter().enumerate() {
        let mut files = Vec::new();
        sources(&src.join(room), &mut files);
        assert!(!files.is_empty(), "no sources in {room}");
        for file in files {
            let text = std::fs::read_to_string(&file).unwrap();
            // Tests may use what comes later, as judges.
            let code = text.split("#[cfg(test)]").next().unwrap();
            for later in &ROOMS[place + 1..] {
                if code.contains(&format!("use crate::{later}")) {
                    violations.push(format!("{} uses {later}", file.strip_prefix(&src).unwrap().display()));
                }
            }
        }
    }
    assert!(violations.is_empty(), "{violations:#?}");
}
