//! Scene files of other programs: what they hold becomes one mesh, what is not read is told, and damage is told in
//! one line.
#![cfg(feature = "files")]

mod gltf;
mod stl;

use phr::scene::{Limits, Scene, SceneError, load, load_within};
use serde_json::{Value, json};
use std::path::Path;
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn read_in(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    load(&path)
}

fn read(name: &str, content: impl AsRef<[u8]>) -> Scene {
    read_in(folder().path(), name, content).unwrap_or_else(|error| panic!("{error}"))
}

fn message(name: &str, content: impl AsRef<[u8]>) -> String {
    let message = read_in(folder().path(), name, content).expect_err("an error").to_string();
    assert!(message.contains(name) && !message.contains('\n') && message.contains(';'), "{message}");
    message
}

fn corners(scene: &Scene) -> Vec<[[f32; 3]; 3]> {
    (0..scene.mesh.len() as u32).map(|i| scene.mesh.corners(i).map(|p| p.to_array())).collect()
}

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.25]];

/// The square's positions, then indices of two triangles in bytes, shorts and words.
fn bytes() -> Vec<u8> {
    let mut bytes: Vec<u8> = SQUARE.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0u8, 1, 2, 0, 2, 3, 0, 0]);
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    bytes.extend([0u32, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    bytes
}

/// Accessors: 0 positions, 1 to 3 indices in bytes, shorts, words.
fn document(uri: Option<&str>) -> Value {
    let length = bytes().len();
    let mut buffer = json!({"byteLength": length});
    if let Some(uri) = uri {
        buffer["uri"] = uri.into();
    }
    json!({
        "asset": {"version": "2.0"},
        "buffers": [buffer],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 6},
            {"buffer": 0, "byteOffset": 56, "byteLength": 12},
            {"buffer": 0, "byteOffset": 68, "byteLength": 24},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
            {"bufferView": 1, "componentType": 5121, "type": "SCALAR", "count": 6},
            {"bufferView": 2, "componentType": 5123, "type": "SCALAR", "count": 6},
            {"bufferView": 3, "componentType": 5125, "type": "SCALAR", "count": 6},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    })
}

fn glb(document: &Value, binary: &[u8]) -> Vec<u8> {
    let mut json = serde_json::to_vec(document).unwrap();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json[..]), (b"BIN\0", binary)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// The document after a change, as GLB.
fn changed(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let mut document = document(None);
    change(&mut document);
    glb(&document, &bytes())
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let word =
            chunk.iter().chain([0, 0].iter()).take(3).fold(0u32, |word, byte| word << 8 | u32::from(*byte));
        for digit in 0..4 {
            let digit =
                if digit <= chunk.len() { DIGITS[(word >> (18 - 6 * digit) & 63) as usize] } else { b'=' };
            text.push(digit as char);
        }
    }
    text
}

fn two() -> Vec<[[f32; 3]; 3]> {
    let [a, b, c, d] = SQUARE;
    vec![[a, b, c], [a, c, d]]
}

const ASCII: &str = "solid first thing\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1e0 0 0\n   \
                     vertex 1 1 0\n  endloop\n endfacet\nendsolid first thing\nSOLID\nFACET normal nan 0 0\nOUTER LOOP\n\
                     VERTEX 0 0 0\nVERTEX 1 1 0\nVERTEX 0 1 0.25\nENDLOOP\nENDFACET\nENDSOLID\n";

fn binary_stl(title: &[u8]) -> Vec<u8> {
    let mut bytes = title.to_vec();
    bytes.resize(80, b' ');
    bytes.extend(2u32.to_le_bytes());
    for triangle in two() {
        let normal = [[0f32, 0., 1.]];
        bytes.extend(normal.iter().chain(&triangle).flatten().flat_map(|x| x.to_le_bytes()));
        bytes.extend([7, 7]);
    }
    bytes
}

/// Nothing is left out without a word.
#[test]
fn what_is_not_read_is_told() {
    let elsewhere = changed(|d| {
        d["nodes"].as_array_mut().unwrap().push(json!({"mesh": 0}));
        d["scenes"] = json!([{"nodes": [0]}]);
    });
    let extension = changed(|d| d["extensionsUsed"] = json!(["MSFT_lod", "MSFT_lod"]));
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face \
               1\nproperty list uchar int vertex_indices\nelement material 2\nproperty int id\nend_header\n0 0 0\n1 0 \
               0\n0 1 0\n3 0 1 2\n7\n8\n";
    let obj = "\u{feff}v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nsurf 0 1 0 1 1 2 3 1\n";
    for (name, content, told) in [
        ("x.glb", elsewhere, "1 nodes with a mesh stand in other scenes"),
        ("x.glb", extension, "the extension MSFT_lod is not applied"),
        ("x.ply", ply.into(), "2 entries of the element material are not read"),
        ("x.obj", obj.into(), "1 free-form curves and surfaces are not read"),
    ] {
        let remarks = read(name, content).remarks();
        assert!(remarks.len() == 1 && remarks[0].contains(told), "{remarks:?}");
    }
}

/// A file without a usable triangle tells why.
#[test]
fn why_a_file_is_empty_is_told() {
    let elsewhere = changed(|d| {
        d["nodes"] = json!([{}, {"mesh": 0}, {"mesh": 0}]);
        d["scenes"] = json!([{"nodes": [0]}]);
    });
    let points = changed(|d| d["meshes"][0]["primitives"][0]["mode"] = 0.into());
    let out_of_range = changed(|d| d["accessors"][0]["count"] = 1.into());
    for (content, told) in [
        (elsewhere, "among the 0 given (2 nodes with a mesh stand in other scenes"),
        (
            points,
            "among the 0 given (left out as no triangles: 1 points, 0 lines, 0 without a whole triangle)",
        ),
        (
            out_of_range,
            "among the 2 given (2 triangles dropped: 2 with indices out of range, first: mesh 0, primitive 0, \
             triangle 0)",
        ),
    ] {
        let message = message("x.glb", content);
        assert!(message.contains(told), "{message}");
    }
}

/// What messages quote of a file, and its own name, is in one line without control characters, and no longer than a line
/// is read.
#[test]
fn messages_are_one_line_whatever_they_quote() {
    let header = |element: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             element face 1\nproperty list uchar int vertex_indices\nelement {element}\nend_header\n0 0 0\n1 0 0\n\
             0 1 0\n3 0 1 2\n"
        )
    };
    let long = "e".repeat(60_000);
    for quoted in ["a\x1b[31m\x07", &long] {
        let scene = read("x.ply", header(&format!("{quoted} 1\nproperty int i")) + "7\n");
        let remarks = scene.remarks();
        assert!(remarks.len() == 1 && remarks[0].contains("1 entries of the element"), "{remarks:?}");
        let faults =
            [header(&format!("{quoted} 1")), header(&format!("{quoted} 1\nproperty int i")) + "none\n"];
        for line in remarks.into_iter().chain(faults.map(|file| message("x.ply", file))) {
            assert!(!line.contains(char::is_control) && line.len() < 1000, "{line}");
        }
    }
    if cfg!(unix) {
        let error = read_in(folder().path(), "a\nb\x1b.obj", "").unwrap_err().to_string();
        assert!(error.contains("a?b?.obj: no usable triangle"), "{error}");
        let scene = read("a\nb\x1b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\np 1\n");
        assert!(scene.remarks()[0].starts_with("a?b?.obj: left out"), "{:?}", scene.remarks());
    }
}

/// Whatever the bytes, loading ends with a scene or a message.
#[test]
fn damaged_files_never_panic() {
    let folder = folder();
    let data = format!("data:;base64,{}", base64(&bytes()));
    let sparse = changed(|d| {
        d["accessors"][0]["sparse"] = json!({"count": 1, "indices": {"bufferView": 1, "componentType": 5121},
            "values": {"bufferView": 0}});
    });
    let files: [(&str, Vec<u8>); 5] = [
        ("x.stl", ASCII.as_bytes().to_vec()),
        ("x.stl", binary_stl(b"solid")),
        ("x.glb", changed(|_| ())),
        ("x.glb", sparse),
        ("x.gltf", document(Some(&data)).to_string().into_bytes()),
    ];
    let limits = Limits::of_machine();
    let mut accepted = 0;
    for (name, bytes) in &files {
        let path = folder.path().join(name);
        let mut attempt = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            match load_within(&path, &limits) {
                Ok(scene) => accepted += usize::from(!scene.mesh.is_empty()),
                Err(error) => assert!(!error.to_string().contains(char::is_control), "{error}"),
            }
            // Some file systems wait for the disk when a file is replaced, not when it is gone before.
            std::fs::remove_file(&path).unwrap();
        };
        for at in 0..bytes.len() {
            attempt(&bytes[..at]);
            for value in [bytes[at] ^ 1, bytes[at] ^ 0x80, b'9', 0, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] = value;
                attempt(&damaged);
            }
        }
    }
    assert!(accepted > 100, "small damage to a coordinate is no error: {accepted}");
}
