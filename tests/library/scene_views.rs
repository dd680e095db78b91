//! The cameras of scene files: those of a `views.json` beside them, or some around the mesh.
#![cfg(feature = "files")]

use crate::scene_files::{OBJ, binary_ply, write, zstd};
use phr::scene::load;
use serde_json::json;

#[test]
fn cameras_come_from_views_json() {
    let dir = tempfile::tempdir().unwrap();
    let path = write(&dir, "small.ply.zst", zstd(binary_ply(false)));
    let other = write(&dir, "other.obj", OBJ);
    let view = r#"{"eye": [1, 2, 3], "target": [0, 0, 0.5], "up": [0, 0, 1], "fov_y_deg": 50}"#;
    write(&dir, "views.json", format!(r#"{{"small": [{view}, {view}]}}"#));
    let scene = load(&path).unwrap();
    assert_eq!(scene.views.len(), 2);
    assert_eq!((scene.views[1].eye.to_array(), scene.views[1].fov_y_deg), ([1.0, 2.0, 3.0], 50.0));
    let scene = load(&other).unwrap();
    assert_eq!((scene.views.len(), scene.remarks()), (3, vec![]), "placed around the geometry");
    for of_another_program in ["[1, 2]", r#"{"cameras": [{"fov": 50}]}"#] {
        write(&dir, "views.json", of_another_program);
        let scene = load(&path).unwrap();
        assert_eq!(scene.views.len(), 3, "{of_another_program}");
        assert!(scene.remarks().iter().any(|remark| remark.contains("views.json has no cameras of small")));
    }

    // Whatever has that name, the scene is read.
    write(&dir, "views.json", format!(r#"{{"others": [{}]}}"#, " ".repeat(1 << 20)));
    let remarks = load(&path).unwrap().remarks();
    assert_eq!(remarks, ["small.ply.zst: views.json is not read: larger than 1048576 bytes"]);
    std::fs::remove_file(dir.path().join("views.json")).unwrap();
    std::fs::create_dir(dir.path().join("views.json")).unwrap();
    assert_eq!(load(&path).unwrap().remarks(), ["small.ply.zst: views.json is not read: not a regular file"]);
    std::fs::remove_dir(dir.path().join("views.json")).unwrap();

    for (json, expected) in [
        ("{", "line 1 column 1"),
        ("{\n\"small\": 3}", "line 2"),
        (r#"{"small": [{"eye": [1, 2], "target": [0, 0, 0], "up": [0, 0, 1], "fov_y_deg": 50}]}"#, "line 1"),
        (r#"{"small": [{"eye": [1, 2, 3], "up": [0, 0, 1], "fov_y_deg": 50}]}"#, "missing field `target`"),
        (&format!(r#"{{"small": [{}]}}"#, view.replace("50", "0")), "view 0 of small: fov_y_deg"),
        (
            &format!(r#"{{"small": [{}]}}"#, view.replace("[0, 0, 0.5]", "[1, 2, 3]")),
            "eye and target coincide",
        ),
        (&format!(r#"{{"small": [{}]}}"#, view.replace("[0, 0, 1]", "[0, 0, 0]")), "up is zero"),
    ] {
        write(&dir, "views.json", json);
        let message = load(&path).expect_err(json).to_string();
        assert!(
            message.contains("views.json") && message.contains(expected),
            "{expected} is not in: {message}"
        );
        assert!(!message.contains('\n'), "{message}");
    }
}

/// Cameras are placed around a glTF scene though its file has some: that is told, unless `views.json` has them.
#[test]
fn cameras_of_gltf_are_remarked() {
    let dir = tempfile::tempdir().unwrap();
    let camera = json!({"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}});
    let file = json!({
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA", "byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "cameras": [camera, camera],
        "nodes": [{"mesh": 0}, {"camera": 1}, {"camera": 0}],
    });
    let path = write(&dir, "x.gltf", file.to_string());
    let scene = load(&path).unwrap();
    assert_eq!(scene.remarks(), ["x.gltf: 2 cameras of the file are not applied, give theirs in views.json"]);
    assert_eq!((scene.mesh.len(), scene.views.len()), (1, 3));
    let view = json!({"eye": [1, 2, 3], "target": [0, 0, 0], "up": [0, 0, 1], "fov_y_deg": 50});
    write(&dir, "views.json", json!({"x": [view]}).to_string());
    let scene = load(&path).unwrap();
    assert_eq!((scene.remarks(), scene.views.len()), (vec![], 1));
}
