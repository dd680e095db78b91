//! What a scene file may cost: it is refused in one line before it takes the memory or the time of the machine.
#![cfg(feature = "files")]

use phr::scene::{Limits, load, load_within};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

const HEADER: &str = "property float x\nproperty float y\nproperty float z\n";

/// A binary PLY of three vertices (or as many as `vertices` says) and a face with a count of four bytes.
fn ply(vertices: &str, count: u32) -> Vec<u8> {
    let mut file = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n{HEADER}element face 1\n\
         property list uint int vertex_indices\nend_header\n"
    )
    .into_bytes();
    [0.0f32, 0., 0., 1., 0., 0., 0., 1., 0.].iter().for_each(|x| file.extend(x.to_le_bytes()));
    file.extend(count.to_le_bytes());
    [0u32, 1, 2].iter().for_each(|i| file.extend(i.to_le_bytes()));
    file
}

fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

/// `head`, as many bytes as `fill` gives, and `tail`, compressed.
fn compressed(head: &[u8], fill: u8, times: u64, tail: &[u8]) -> Vec<u8> {
    let mut encoder = zstd::Encoder::new(Vec::new(), 1).unwrap();
    encoder.write_all(head).unwrap();
    std::io::copy(&mut std::io::repeat(fill).take(times), &mut encoder).unwrap();
    encoder.write_all(tail).unwrap();
    encoder.finish().unwrap()
}

fn refusal(path: &Path, memory: u64) -> String {
    let message = load_within(path, &Limits { memory }).expect_err("too much").to_string();
    assert!(!message.contains('\n') && message.contains(';'), "{message}");
    message
}

#[test]
fn declared_sizes_are_refused_before_memory_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "x.ply", ply("3", 3));
    assert_eq!(load(&path).unwrap().mesh.len(), 1);
    let path = write(folder.path(), "x.ply", ply("400000000000", 3));
    let message = refusal(&path, 1 << 40);
    assert!(message.contains("takes 4577637 MiB") && message.contains("--max-memory"), "{message}");
    let mut stl = vec![b' '; 80];
    stl.extend(u32::MAX.to_le_bytes());
    let message = refusal(&write(folder.path(), "x.stl", stl), 1 << 30);
    assert!(message.contains("takes 196608 MiB or more of memory, of which 1024 MiB"), "{message}");
}

#[test]
fn meshes_that_grow_too_large_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    // A face of 2^32 - 1 vertices, the indices zeros without end.
    let file = compressed(&ply("3", u32::MAX), 0, 200 << 20, &[]);
    let message = refusal(&write(folder.path(), "x.ply.zst", file), 16 << 20);
    assert!(message.contains("of which 16 MiB"), "{message}");
    let mut obj = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    obj += &"f 1 2 3\n".repeat(200_000);
    let path = write(folder.path(), "x.obj", obj);
    assert!(refusal(&path, 1 << 20).contains("of which 1 MiB"));
    assert_eq!(load_within(&path, &Limits { memory: 32 << 20 }).unwrap().mesh.len(), 200_000);
}

#[test]
fn bombs_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (name, head, fill) in [("x.obj.zst", &b"# "[..], b'x'), ("x.ply.zst", &b"ply\ncomment "[..], b' ')] {
        let bomb = compressed(head, fill, 300 << 20, b"");
        let message = refusal(&write(folder.path(), name, bomb), u64::MAX);
        assert!(message.contains("200-fold when decompressed; decompress it first"), "{message}");
    }
}

/// Lines longer than what is kept of one are passed over where they say nothing, refused elsewhere.
#[test]
fn long_lines_take_no_memory() {
    let folder = tempfile::tempdir().unwrap();
    let long = 40u64 << 20;
    let obj = b"\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let file = compressed(b"# ", b'x', long, obj);
    assert_eq!(load(write(folder.path(), "x.obj.zst", file)).unwrap().mesh.len(), 1);
    let file = compressed(b"f 1 1 1", b'1', long, obj);
    let message = refusal(&write(folder.path(), "x.obj.zst", file), u64::MAX);
    assert!(message.contains("line 1: longer than 16 MiB; split"), "{message}");
    let text = ply("3", 3);
    let comment = [&b"ply\ncomment "[..], &b"\n"[..]];
    let file = compressed(comment[0], b'x', long, &[comment[1], &text[4..]].concat());
    assert_eq!(load(write(folder.path(), "x.ply.zst", file)).unwrap().mesh.len(), 1);
    for (head, expected) in [
        (&b"ply\nelement "[..], "longer than 64 KiB"),
        (
            &b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n1"[..],
            "a word of more than a kilobyte",
        ),
    ] {
        let file = compressed(head, b'1', long, b"");
        let message = refusal(&write(folder.path(), "x.ply.zst", file), u64::MAX);
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
#[cfg(unix)]
fn pipes_and_devices_are_no_files() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.ply");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    std::os::unix::fs::symlink("/dev/zero", folder.path().join("zero.obj")).unwrap();
    for path in [pipe.clone(), folder.path().join("zero.obj")] {
        assert!(refusal(&path, u64::MAX).contains("not a regular file"));
    }
    let scene = write(folder.path(), "x.ply", ply("3", 3));
    std::fs::rename(pipe, folder.path().join("views.json")).unwrap();
    assert_eq!(load(&scene).unwrap().remarks(), ["x.ply: views.json is not read: not a regular file"]);
}

/// Vertices and indices without data, of which a few are replaced: they are refused whatever memory there is.
#[test]
fn zeros_from_nowhere_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let data = "data:;base64,AAECAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAA==";
    // A sparse accessor of `count` positions, the first three of which are a triangle, in `places`.
    let file = |count: u64, places: usize, primitive: &str| {
        let nodes = vec![r#"{"mesh": 0}"#; places].join(",");
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"uri": "{data}", "byteLength": 40}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 3}}, {{"buffer": 0, "byteOffset": 4, "byteLength": 36}}],
            "accessors": [{{"componentType": 5126, "type": "VEC3", "count": {count}, "sparse": {{"count": 3,
                "indices": {{"bufferView": 0, "componentType": 5121}}, "values": {{"bufferView": 1}}}}}},
                {{"bufferView": 0, "componentType": 5121, "type": "SCALAR", "count": 3}}],
            "nodes": [{nodes}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}{primitive}}}]}}]}}"#
        )
    };
    let indexed = r#", "indices": 1"#;
    let path = folder.path().join("x.gltf");
    std::fs::write(&path, file(1000, 2, indexed)).unwrap();
    let mesh = load(&path).unwrap().mesh;
    assert_eq!((mesh.len(), mesh.vertices().len()), (2, 1000), "in one place");
    assert_eq!(mesh.corners(1).map(|p| p.to_array()), [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    for (count, primitive, expected) in [
        (5_000_000_000, indexed, "5000000000 vertices, of at most 2^32; split"),
        (4_000_000_000, indexed, "45777 MiB of zeros from 1 KiB; export it with the data"),
        (30_000_000, indexed, "344 MiB of zeros"),
        (20_000_000, "", "306 MiB of zeros"),
    ] {
        std::fs::write(&path, file(count, 1, primitive)).unwrap();
        let message = refusal(&path, u64::MAX);
        assert!(message.contains(expected), "{message}");
    }
}

/// Small text that is parsed into much: objects without a member, and one child a thousand times.
#[test]
fn what_json_is_parsed_into_counts() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.gltf");
    let nodes = |count: usize| vec!["{}"; count].join(",");
    std::fs::write(&path, format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{}]}}"#, nodes(20_000))).unwrap();
    assert!(refusal(&path, 1 << 20).contains("--max-memory"));
    assert!(!refusal(&path, 32 << 20).contains("--max-memory"), "no triangle in it");
    let children = vec!["1"; 1000].join(",");
    let text = format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"children":[{children}]}},{{}}]}}"#);
    std::fs::write(&path, text).unwrap();
    assert!(refusal(&path, 32 << 20).contains("node 1: child of two nodes"));
}
