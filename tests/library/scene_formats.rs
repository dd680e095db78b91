//! glTF, GLB and STL: what they hold becomes one mesh in the places of its nodes, what is no triangle is counted, and
//! damage is told in one line.
#![cfg(feature = "files")]

use phr::scene::{Scene, SceneError, load};
use serde_json::{Value, json};
use std::io::Write;
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

#[test]
fn buffers_are_in_the_container_beside_it_or_in_the_text() {
    let folder = folder();
    std::fs::write(folder.path().join("my square.bin"), bytes()).unwrap();
    let data = format!("data:application/octet-stream;base64,{}", base64(&bytes()));
    let mut gz = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gz.write_all(&changed(|_| ())).unwrap();
    let files: [(&str, Vec<u8>); 5] = [
        ("square.glb", changed(|_| ())),
        ("square.glb.gz", gz.finish().unwrap()),
        ("square.GLB.zst", zstd::encode_all(&changed(|_| ())[..], 3).unwrap()),
        ("square.gltf", document(Some("my%20square.bin")).to_string().into_bytes()),
        ("square.gltf.zst", zstd::encode_all(document(Some(&data)).to_string().as_bytes(), 3).unwrap()),
    ];
    for (name, content) in files {
        let scene = read_in(folder.path(), name, content).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((corners(&scene), scene.mesh.vertices().len()), (two(), 4), "{name}");
        assert_eq!((scene.name.as_str(), scene.contents.objects), ("square", 1));
        assert!(scene.remarks().is_empty());
        assert_eq!(scene.views[0].up, glam::Vec3::Y, "the format's, not the low axis");
    }
}

#[test]
fn indices_of_all_types_and_none() {
    for accessor in 1..=3 {
        let scene = read("x.glb", changed(|d| d["meshes"][0]["primitives"][0]["indices"] = accessor.into()));
        assert_eq!(corners(&scene), two(), "accessor {accessor}");
    }
    let [a, b, c, d] = SQUARE;
    let without = |mode: u32| {
        let primitive = json!({"attributes": {"POSITION": 0}, "mode": mode});
        corners(&read("x.glb", changed(|d| d["meshes"][0]["primitives"] = json!([primitive]))))
    };
    assert_eq!(without(4), [[a, b, c]], "the fourth vertex is left over");
    assert_eq!(without(5), [[a, b, c], [b, d, c]]);
    assert_eq!(without(6), [[b, c, a], [c, d, a]]);
}

#[test]
fn what_is_no_triangle_is_counted() {
    let scene = read(
        "x.glb",
        changed(|d| {
            let primitives = d["meshes"][0]["primitives"].as_array_mut().unwrap();
            primitives.extend((0..4).map(|mode| json!({"attributes": {"POSITION": 0}, "mode": mode})));
            primitives.push(json!({"attributes": {"NORMAL": 0}}));
            primitives.push(json!({"attributes": {"POSITION": 0}}));
        }),
    );
    let contents = &scene.contents;
    assert_eq!((scene.mesh.len(), scene.mesh.vertices().len()), (3, 4), "vertices are shared");
    assert_eq!((contents.objects, contents.points, contents.lines, contents.empty), (7, 1, 3, 2));
    assert!(scene.remarks()[0].contains("1 points, 3 lines, 2 without"), "{:?}", scene.remarks());
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

/// A small file may have as many primitives as places for them: each is looked at once.
#[test]
fn what_is_no_triangle_counts_in_each_of_its_places() {
    let scene = read(
        "x.glb",
        changed(|d| {
            let mut primitives = vec![json!({"attributes": {"POSITION": 0}, "mode": 0}); 3000];
            primitives.push(json!({"attributes": {"POSITION": 0}, "indices": 1}));
            d["meshes"][0]["primitives"] = primitives.into();
            d["nodes"] = vec![json!({"mesh": 0}); 3000].into();
            d["scenes"] = json!([{"nodes": (0..3000).collect::<Vec<_>>()}]);
        }),
    );
    assert_eq!((scene.contents.objects, scene.contents.points), (3000 * 3001, 3000 * 3000));
    assert_eq!((scene.mesh.len(), scene.mesh.vertices().len()), (3000 * 2, 3000 * 4));
}

/// What an application adds may be any value.
#[test]
fn extras_are_passed_over() {
    for extras in
        [json!({"a": [1, {"b": 2}]}), json!("text"), json!(5), json!([[1], 2]), json!(true), json!(null)]
    {
        let file = changed(|d| {
            d["extras"] = extras.clone();
            d["asset"]["extras"] = extras.clone();
            d["nodes"][0]["extras"] = extras.clone();
        });
        assert_eq!(corners(&read("x.glb", file)), two(), "{extras}");
    }
}

#[test]
fn nodes_place_their_meshes() {
    let half = 0.5f64.sqrt();
    let scene = read(
        "x.glb",
        changed(|d| {
            d["nodes"] = json!([
                {"translation": [10, 0, 0], "children": [1, 2, 3]},
                {"mesh": 0, "scale": [2, 3, 4]},
                // A quarter turn about z: x becomes y.
                {"mesh": 0, "rotation": [0, 0, half, half]},
                {"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
                {"mesh": 0},
            ]);
        }),
    );
    assert_eq!(scene.mesh.len(), 6, "the node outside of the scene does not count");
    assert_eq!(scene.contents.objects, 3);
    let found = corners(&scene);
    assert_eq!(found[0], [[10., 0., 0.], [12., 0., 0.], [12., 3., 0.]]);
    let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(near(found[2][1], [10., 1., 0.]) && near(found[2][2], [9., 1., 0.]), "{:?}", found[2]);
    // A mirror turns triangles round: their front stays where it was.
    assert_eq!(found[4], [[10., 0., 5.], [9., 1., 5.], [9., 0., 5.]]);

    let all = read(
        "x.glb",
        changed(|d| {
            d["scenes"] = json!([]);
            d["nodes"] = json!([{"children": [1]}, {"mesh": 0}, {"mesh": 0}]);
        }),
    );
    assert_eq!(all.mesh.len(), 4, "without a scene all nodes count");
}

#[test]
fn sparse_and_small_positions() {
    // The third vertex is replaced by the second's position; indices in bytes at 49, value at 12.
    let sparse = json!({"count": 1, "indices": {"bufferView": 1, "byteOffset": 2, "componentType": 5121},
        "values": {"bufferView": 0, "byteOffset": 12}});
    let scene = read("x.glb", changed(|d| d["accessors"][0]["sparse"] = sparse.clone()));
    assert_eq!(scene.mesh.vertices(), [SQUARE[0], SQUARE[1], SQUARE[1], SQUARE[3]]);
    let zeros = read(
        "x.glb",
        changed(|d| {
            d["accessors"][0]["sparse"] = sparse.clone();
            d["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        }),
    );
    assert_eq!(zeros.mesh.vertices(), [[0.; 3], [0.; 3], SQUARE[1], [0.; 3]]);
    // Positions as normalized shorts, eight bytes apart.
    let shorts: Vec<u8> = [0i16, 0, 0, 9, 32767, 0, 0, 9, 0, -32768, 0, 9, 0, 0, 0, 9]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let mut document = document(None);
    document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    document["accessors"][0]["componentType"] = 5122.into();
    document["accessors"][0]["normalized"] = true.into();
    document["bufferViews"][0] = json!({"buffer": 0, "byteLength": 32, "byteStride": 8});
    let scene = read("x.glb", glb(&document, &[&shorts[..], &bytes()[32..]].concat()));
    assert_eq!(scene.mesh.vertices(), [[0.; 3], [1., 0., 0.], [0., -1., 0.], [0.; 3]]);
}

#[test]
fn wrong_gltf_is_told() {
    let required = |name: &str| changed(|d| d["extensionsRequired"] = json!([name]));
    let cases: Vec<(Vec<u8>, &str)> = vec![
        (
            required("KHR_draco_mesh_compression"),
            "KHR_draco_mesh_compression, which is not read; decompress it",
        ),
        (required("EXT_meshopt_compression"), "EXT_meshopt_compression, which is not read; decompress it"),
        (required("ACME_shapes"), "needs ACME_shapes"),
        (changed(|d| d["asset"]["version"] = "1.0".into()), "version 1.0; export it as glTF 2.0"),
        (changed(|d| d["nodes"] = json!([{"children": [0]}])), "node 0: child of two nodes"),
        (changed(|d| d["nodes"][0]["children"] = json!([9])), "node 9: there is no such node"),
        (changed(|d| d["nodes"][0]["mesh"] = 7.into()), "mesh 7: there is no such mesh"),
        (changed(|d| d["scene"] = 3.into()), "scene 3: there is no such scene"),
        (changed(|d| d["accessors"][0]["count"] = 5.into()), "bufferView 0: ends before its last element"),
        (changed(|d| d["accessors"][0]["count"] = (1u64 << 60).into()), "MiB or more of memory"),
        (changed(|d| d["accessors"][1]["count"] = (1u64 << 60).into()), "MiB or more of memory"),
        (changed(|d| d["accessors"][0]["type"] = "VEC2".into()), "accessor 0: positions that are no vectors"),
        (changed(|d| d["accessors"][0]["type"] = "VEC9".into()), "accessor 0: of an unknown type"),
        (changed(|d| d["accessors"][1]["componentType"] = 5126.into()), "accessor 1: indices that are no"),
        (changed(|d| d["bufferViews"][0]["byteOffset"] = u64::MAX.into()), "bufferView 0: beyond the end"),
        (changed(|d| d["bufferViews"][0]["byteStride"] = 4.into()), "bufferView 0: a stride shorter"),
        (changed(|d| d["buffers"][0]["byteLength"] = 4096.into()), "buffer 0: has 92 bytes of 4096"),
        (changed(|d| d["buffers"][0]["uri"] = "none.bin".into()), "none.bin: No such file"),
        (changed(|d| d["buffers"][0]["uri"] = "http://a.b/c".into()), "http://a.b/c is not a file"),
        (changed(|d| d["buffers"][0]["uri"] = "a/..%2f../c".into()), "outside the scene's folder"),
        (changed(|d| d["buffers"][0]["uri"] = "/etc/hostname".into()), "outside the scene's folder"),
        (changed(|d| d["buffers"][0]["uri"] = "data:;base64,*".into()), "buffer 0: a data URI"),
        (changed(|d| d["meshes"][0]["primitives"][0]["mode"] = 1.into()), "no usable triangle"),
        (changed(|d| d["nodes"] = "none".into()), "JSON, line 1 column"),
        (b"glTF\x01\0\0\0\0\0\0\0".to_vec(), "container version 1"),
        (b"hello, world".to_vec(), "does not begin with glTF"),
    ];
    for (content, expected) in cases {
        let message = message("x.glb", content);
        assert!(message.contains(expected), "{expected} is not in: {message}");
    }
    let out_of_range = changed(|d| d["accessors"][0]["count"] = 3.into());
    let scene = read("x.glb", out_of_range);
    assert_eq!((scene.mesh.len(), scene.dropped.out_of_range), (1, 1));
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

#[test]
fn stl_is_text_or_binary() {
    let cut = ASCII.trim_end().replace('\n', "\r\n");
    for content in
        [ASCII.as_bytes().to_vec(), cut.into_bytes(), binary_stl(b"made"), binary_stl(b"solid made")]
    {
        let scene = read("x.stl", &content);
        assert_eq!((corners(&scene), scene.mesh.vertices().len()), (two(), 6));
        assert_eq!(scene.contents.objects, if content.starts_with(b"solid f") { 2 } else { 1 });
    }
    assert_eq!(read("x.STL.zst", zstd::encode_all(ASCII.as_bytes(), 3).unwrap()).mesh.len(), 2);
}

#[test]
fn wrong_stl_is_told() {
    let ascii = |from: &str, to: &str| ASCII.replacen(from, to, 1).into_bytes();
    let binary = binary_stl(b"made");
    let mut more = binary.clone();
    more[80] = 3;
    let mut many = binary.clone();
    many[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let limited = ["takes 196608 MiB", "triangle 2 of 4294967295"];
    let cases: Vec<(Vec<u8>, &str)> = vec![
        (vec![], "header: the data ends here"),
        (binary[..100].to_vec(), "triangle 0 of 2: the data ends here"),
        (more, "triangle 2 of 3: the data ends here"),
        ([&binary[..], b"\0"].concat(), "more data than the header's count"),
        (ascii("vertex 1 1 0", "vertex 1 one 0"), "line 6: a vertex without three numbers"),
        (ascii("   vertex 1 1 0\n", ""), "line 7: a facet of fewer"),
        (ascii("  endloop\n", "vertex 0 0 0\n"), "line 7: a facet of more"),
        (ascii("endfacet", "endfacets"), "line 8: unknown word endfacets"),
        (ascii("ENDSOLID\n", ""), "the data ends here, in a solid"),
        (b"solid\nendsolid\n".to_vec(), "no usable triangle"),
    ];
    for (content, expected) in cases {
        let message = message("x.stl", content);
        assert!(message.contains(expected), "{expected} is not in: {message}");
    }
    // As much as the machine has decides which.
    let message = message("x.stl", many);
    assert!(limited.iter().any(|part| message.contains(part)), "{message}");
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
    let mut accepted = 0;
    for (name, bytes) in &files {
        let mut attempt = |bytes: &[u8]| match read_in(folder.path(), name, bytes) {
            Ok(scene) => accepted += usize::from(!scene.mesh.is_empty()),
            Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
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
