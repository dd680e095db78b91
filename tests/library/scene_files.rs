//! Scene files: every format and compression reads back the same mesh, and nothing in a file makes the
//! loader panic or say less than file, place and remedy.
#![cfg(feature = "files")]

use phr::scene::{Limits, Scene, SceneError, load, load_within};
use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Two triangles and a quad over five vertices.
const VERTICES: [[f32; 3]; 5] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, -2.25], [0.5, 0.5, 1e-3]];
const FACES: [&[u32]; 3] = [&[0, 1, 4], &[1, 2, 4], &[0, 1, 2, 3]];
const TRIANGLES: [[u32; 3]; 4] = [[0, 1, 4], [1, 2, 4], [0, 1, 2], [0, 2, 3]];

pub fn write(dir: &TempDir, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = dir.path().join(name);
    std::fs::write(&path, content).unwrap();
    path
}

/// Loads `content` as a file called `name`.
fn read(name: &str, content: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
    let dir = tempfile::tempdir().unwrap();
    load(write(&dir, name, content))
}

fn message(name: &str, content: impl AsRef<[u8]>) -> String {
    let message = read(name, content).expect_err("an error").to_string();
    assert!(message.contains(name) && !message.contains('\n') && message.contains(';'), "{message}");
    message
}

fn ply_header(format: &str, vertex: &str, face: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made by a test\nelement vertex {}\n{vertex}element face {}\n{face}end_header\n",
        VERTICES.len(),
        FACES.len()
    )
}

const FLOATS: &str = "property float x\nproperty float y\nproperty float z\n";
const LIST: &str = "property list uchar int vertex_indices\n";

fn ascii_ply() -> String {
    let mut text = ply_header("ascii", FLOATS, LIST);
    for [x, y, z] in VERTICES {
        text += &format!("{x} {y} {z}\n");
    }
    for face in FACES {
        text += &format!("{}", face.len());
        face.iter().for_each(|i| text += &format!(" {i}"));
        text += "\n";
    }
    text
}

pub fn binary_ply(big_endian: bool) -> Vec<u8> {
    let order = if big_endian { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = ply_header(order, FLOATS, LIST).into_bytes();
    let mut put = |word: [u8; 4]| bytes.extend(word.iter().copied());
    let f = |x: f32| if big_endian { x.to_be_bytes() } else { x.to_le_bytes() };
    VERTICES.iter().flatten().for_each(|x| put(f(*x)));
    for face in FACES {
        bytes.push(face.len() as u8);
        for i in face {
            bytes.extend(if big_endian { i.to_be_bytes() } else { i.to_le_bytes() });
        }
    }
    bytes
}

fn gzip(bytes: impl AsRef<[u8]>) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes.as_ref()).unwrap();
    encoder.finish().unwrap()
}

/// Compressed with the longest window that the loader must allow.
pub fn zstd(bytes: impl AsRef<[u8]>) -> Vec<u8> {
    let mut encoder = zstd::Encoder::new(Vec::new(), 3).unwrap();
    encoder.long_distance_matching(true).unwrap();
    encoder.window_log(27).unwrap();
    encoder.write_all(bytes.as_ref()).unwrap();
    encoder.finish().unwrap()
}

fn assert_whole(scene: &Scene) {
    assert_eq!(scene.mesh.vertices(), VERTICES);
    assert_eq!(scene.mesh.triangles(), TRIANGLES);
    assert_eq!(scene.dropped.total(), 0);
    assert_eq!(scene.name, "small");
    assert_eq!(scene.views.len(), 3);
    assert!(scene.source.starts_with("file ") && scene.sha.len() == 16);
}

pub const OBJ: &str = "# a comment\nmtllib missing.mtl\no first\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 -2.25\nv 0.5 0.5 1e-3\n\
                   f 1 2 5\nf 2 3 5\nf 1 2 3 4\n";

#[test]
fn every_encoding_reads_back_the_same_mesh() {
    let (ascii, little, big) = (ascii_ply(), binary_ply(false), binary_ply(true));
    let files: [(&str, Vec<u8>); 10] = [
        ("small.ply", ascii.clone().into_bytes()),
        ("small.PLY", ascii.trim_end().as_bytes().to_vec()),
        ("small.ply", ascii.replace('\n', "\r\n").into_bytes()),
        ("small.ply", little.clone()),
        ("small.ply", big.clone()),
        ("small.ply.gz", gzip(&little)),
        ("small.ply.gz", [gzip(&big[..100]), gzip(&big[100..])].concat()),
        ("small.ply.zst", zstd(&big)),
        ("small.ply.zst", zstd(&ascii)),
        ("small.Ply.Zst", zstd(&little)),
    ];
    let mut hashes = Vec::new();
    for (name, content) in files {
        let scene = read(name, content).unwrap_or_else(|e| panic!("{e}"));
        assert_whole(&scene);
        assert_eq!(scene.contents.objects, 1);
        hashes.push(scene.sha);
    }
    assert!(hashes.iter().all(|sha| *sha == hashes[0]), "{hashes:?}");
}

#[test]
fn obj_reads_as_one_mesh() {
    let corners = |scene: &Scene| -> Vec<_> {
        (0..scene.mesh.len() as u32).map(|i| scene.mesh.corners(i).map(|p| p.to_array())).collect()
    };
    let expected = TRIANGLES.map(|t| t.map(|i| VERTICES[i as usize])).to_vec();
    let variants = [
        OBJ.to_owned(),
        OBJ.replace('\n', "\r\n"),
        OBJ.trim_end().to_owned(),
        // Relative indices; texture coordinates and normals that do not exist; two objects and a material.
        OBJ.replace("f 1 2 5", "f -5 -4 -1").replace("f 2 3 5", "o second\nusemtl x\nf 2/7/9 3//9 5/7"),
        OBJ.replace("f 1 2 3 4", "g third\nvt 0 0\nvn 0 0 1\ns off\nl 1 2\np 3\nf 1/1/1 2/1/1 3/1/1 4/1/1"),
        OBJ.replace("f 1 2 3 4", "f 1 2 \\\n3 4"),
        // A weight, a colour, too much of it.
        OBJ.replace("v 0 0 0\n", "v 0 0 0 1.0\n").replace("v 1 0 0\n", "v 1 0 0 0.5 0.5 0.5 1\n"),
    ];
    for text in variants {
        for (name, content) in [
            ("small.obj", text.clone().into_bytes()),
            ("small.obj.gz", gzip(&text)),
            ("small.OBJ.zst", zstd(&text)),
        ] {
            let scene = read(name, content).unwrap_or_else(|e| panic!("{e}\n{text}"));
            assert_eq!(corners(&scene), expected, "{text}");
            assert_eq!(scene.mesh.vertices().len(), 5, "vertices are shared: {text}");
            assert_eq!((scene.name.as_str(), scene.dropped.total()), ("small", 0));
            let begun = text.lines().filter(|line| line.starts_with("o ") || line.starts_with("g ")).count();
            assert_eq!(scene.contents.objects, begun, "{text}");
        }
    }
    // A folder's backslash continues nothing.
    for text in ["# from C:\\models\\", "o C:\\models\\", "mtllib folder\\"] {
        assert_eq!(corners(&read("small.obj", format!("{text}\n{OBJ}")).unwrap()), expected, "{text}");
    }
    // Faces that are points or edges.
    let scene = read("small.obj", OBJ.replace("f 1 2 3 4", "f 1 2\nf 1\nf\nf 1 2 3 4")).unwrap();
    assert_eq!((corners(&scene), scene.contents.empty), (expected.clone(), 3));
    // Vertices are numbered in the order in which faces use them; those in none are left out.
    let scene = read("small.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 4 2 3\nf 2 4 3\n").unwrap();
    assert_eq!(scene.mesh.vertices(), [[0.0, 1.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0]]);
    assert_eq!(scene.mesh.triangles(), [[0, 1, 2], [1, 0, 2]]);
    // Names in other encodings than UTF-8 do not matter.
    let latin = [b"usemtl W\xe4nde\n# caf\xe9\n", OBJ.as_bytes()].concat();
    assert_eq!(corners(&read("small.obj", latin).unwrap()), expected);
}

#[test]
fn other_elements_properties_and_types_are_skipped_or_converted() {
    let mut text = ply_header(
        "ascii",
        "property uchar red\nproperty double z\nproperty double y\nproperty list uchar float weights\nproperty int x\n",
        "property list ushort short normals\nproperty list uint uint vertex_index\nproperty float quality\n",
    );
    text = text.replace(
        "element face",
        "element camera 1\nproperty float fov\nproperty list uchar uchar name\nelement face",
    );
    text += "255 0 0 0 0\n255 0 0 2 0.5 0.5 1\n255 0.5 1 0 1\n255 -2 1 1 7 0\n255 3 2 0 1\n";
    text += "45.0 3 97 98 99\n";
    text += "2 -1 1 3 0 1 4 0.5\n0 3 1 2 4 0.5\n1 7 4 0 1 2 3 0.5\n";
    let scene = read("small.ply", &text).unwrap();
    assert_eq!(scene.mesh.triangles(), TRIANGLES);
    assert_eq!(scene.mesh.vertices()[3], [0.0, 1.0, -2.0]);
    assert_eq!(scene.mesh.vertices()[4], [1.0, 2.0, 3.0]);

    // Faces before vertices, doubles in binary.
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list char uchar vertex_indices\n\
        element vertex 3\nproperty double x\nproperty double y\nproperty double z\nend_header\n\x03\x00\x01\x02"
        .to_vec();
    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.25, 0.0f64].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    let scene = read("small.ply", bytes).unwrap();
    assert_eq!(scene.mesh.triangles(), [[0, 1, 2]]);
    assert_eq!(scene.mesh.vertices()[2], [0.0, 0.25, 0.0]);
}

#[test]
fn unusable_triangles_are_dropped_and_counted() {
    let bad = ascii_ply().replace("3 1 2 4", "3 1 -2 4").replace("4 0 1 2 3", "4 0 1 2 9");
    let scene = read("small.ply", &bad).unwrap();
    assert_eq!((scene.mesh.len(), scene.dropped.out_of_range, scene.dropped.non_finite), (2, 2, 0));
    for huge in ["nan", "inf", "-inf", "1e19", "1e39"] {
        let scene = read("small.ply", ascii_ply().replace("1 1 0.5", &format!("1 1 {huge}"))).unwrap();
        assert_eq!((scene.mesh.len(), scene.dropped.non_finite), (1, 3), "{huge}");
        let scene = read("small.obj", OBJ.replace("v 1 1 0.5", &format!("v 1 1 {huge}"))).unwrap();
        assert_eq!((scene.mesh.len(), scene.dropped.non_finite), (1, 3), "{huge}");
    }
    for index in ["0", "6", "-6", "2147483647", "-2147483648"] {
        let scene = read("small.obj", OBJ.replace("f 1 2 3 4", &format!("f 1 2 3 {index}"))).unwrap();
        assert_eq!((scene.mesh.len(), scene.dropped.out_of_range), (2, 2), "{index}");
    }
    // A file, its reason, the first place and the remedy are told.
    let remarks = |name: &str, content: &str| read(name, content).unwrap().remarks();
    let told = |count: &str, place: &str| {
        format!("{count} with indices out of range, first: {place}; export the file again")
    };
    let out = told("small.ply: 2 triangles dropped: 2", "triangle 1");
    assert_eq!(remarks("small.ply", &bad), [out]);
    let out = told("small.obj: 2 triangles dropped: 2", "line 11");
    assert_eq!(remarks("small.obj", &OBJ.replace("f 1 2 3 4", "f 1 2 3 9")), [out]);
    let huge = "small.obj: 3 triangles dropped: 3 with non-finite or huge vertices, first: triangle 1; export the \
                file again";
    assert_eq!(remarks("small.obj", &OBJ.replace("v 1 1 0.5", "v 1 1 nan")), [huge]);
    let none = message("small.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    assert!(
        none.contains(
            "among the 1 given (1 triangle dropped: 1 with indices out of range, first: line 4); check"
        ),
        "{none}"
    );
    // Faces of one or two vertices have no area and are no triangles.
    let scene = read("small.ply", ascii_ply().replace("3 1 2 4", "2 1 2")).unwrap();
    assert_eq!((scene.mesh.len(), scene.dropped.total()), (3, 0));
}

#[test]
fn wrong_files_are_told_with_place_and_remedy() {
    let ascii = ascii_ply();
    let little = binary_ply(false);
    let replaced = |from: &str, to: &str| {
        assert!(ascii.contains(from), "{from}");
        ascii.replacen(from, to, 1).into_bytes()
    };
    let obj = |from: &str, to: &str| OBJ.replacen(from, to, 1).into_bytes();
    let cases: [(&str, Vec<u8>, &str); 31] = [
        ("x.ply", vec![], "header"),
        ("x.ply", b"solid".to_vec(), "header"),
        ("x.ply", b"ply\n".to_vec(), "header"),
        ("x.ply", vec![0xff; 300], "header"),
        ("x.ply", replaced("format ascii", "format latin"), "header: Unknown format: latin"),
        ("x.ply", replaced("property float y", "property real y"), "real"),
        ("x.ply", replaced("property float y\n", ""), "element vertex: no properties x, y and z"),
        ("x.ply", replaced("vertex_indices", "indices"), "element face: no list vertex_indices"),
        ("x.ply", replaced("element face", "element strip"), "element face: missing"),
        ("x.ply", replaced("element face 3", "element face three"), "three"),
        ("x.ply", replaced("element face 3", "element face -3"), "-3"),
        ("x.ply", replaced("element face", "element vertex 0\nelement face"), "given twice"),
        (
            "x.ply",
            replaced("element face", "element none 99999999999\nelement face"),
            "element none: no property",
        ),
        ("x.ply", replaced("element face 3", "element face 4"), "face 3 of 4: the data ends here"),
        ("x.ply", replaced("element face 3", "element face 2"), "more data"),
        ("x.ply", replaced("element vertex 5", "element vertex 4"), "face 0 of 3"),
        ("x.ply", replaced("element vertex 5", "element vertex 6"), "face 2 of 3: the data ends here"),
        ("x.ply", replaced("element vertex 5", "element vertex 1000000"), "vertex 9 of 1000000"),
        ("x.ply", replaced("1 0 0", "1 zero 0"), "vertex 1 of 5"),
        ("x.ply", replaced("3 1 2 4", "3 1 2.5 4"), "face 1 of 3"),
        ("x.ply", replaced("3 1 2 4", "-3 1 2 4"), "face 1 of 3"),
        ("x.ply", replaced("3 1 2 4", "999 1 2 4"), "face 1 of 3"),
        ("x.ply", little[..little.len() - 1].to_vec(), "face 2 of 3: the data ends here"),
        ("x.ply", [&little[..], b"\0"].concat(), "more data"),
        ("x.ply", replaced("element vertex 5", "element vertex 0").into_iter().take(150).collect(), "header"),
        ("x.ply.gz", little.clone(), "header"),
        ("x.ply.zst", zstd(&little)[..80].to_vec(), ""),
        ("x.obj", obj("v 1 0 0", "v 1 zero 0"), "line 5: position parse error"),
        ("x.obj", obj("v 1 0 0", "v 1 0"), "line 5: position parse error"),
        ("x.obj", obj("f 2 3 5", "f 2 x 5"), "line 10: a face's index is no number"),
        ("x.obj", b"v 0 0 0\nv 1 0 0\n".to_vec(), "no usable triangle"),
    ];
    for (name, content, expected) in cases {
        let message = message(name, content);
        assert!(message.contains(expected), "{expected} is not in: {message}");
    }
    let empty = replaced("element face 3", "element face 0");
    let empty = &empty[..empty.len() - "3 0 1 4\n3 1 2 4\n4 0 1 2 3\n".len()];
    assert!(message("x.ply", empty).contains("no usable triangle"));
    assert!(message("x.obj", "").contains("no usable triangle"));
}

#[test]
fn wrong_paths_are_told() {
    let dir = tempfile::tempdir().unwrap();
    let said = |path: &Path| load(path).expect_err("an error").to_string();
    assert!(said(&dir.path().join("none.ply")).contains("none.ply: No such file"));
    assert!(said(dir.path()).contains("a directory"));
    std::fs::create_dir(dir.path().join("folder.ply")).unwrap();
    assert!(said(&dir.path().join("folder.ply")).contains("a directory"));
    assert!(said(&write(&dir, "mesh.fbx", "")).contains("not a scene file"));
    assert!(said(&write(&dir, "mesh", "")).contains("not a scene file"));
}

/// Whatever the bytes, loading ends with a scene or a message.
#[test]
fn damaged_files_never_panic() {
    let files: [(&str, Vec<u8>); 6] = [
        ("x.ply", ascii_ply().into_bytes()),
        ("x.ply", binary_ply(false)),
        ("x.ply", binary_ply(true)),
        ("x.obj", OBJ.replace("f 1 2 5", "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 -1/-1/-1").into_bytes()),
        ("x.ply.gz", gzip(binary_ply(false))),
        ("x.ply.zst", zstd(ascii_ply())),
    ];
    let dir = tempfile::tempdir().unwrap();
    let limits = Limits::of_machine();
    let mut accepted = 0;
    let mut attempt = |name: &str, bytes: &[u8]| {
        let path = write(&dir, name, bytes);
        match load_within(&path, &limits) {
            Ok(scene) => {
                assert!(!scene.mesh.is_empty() && scene.views.iter().all(|v| v.check().is_ok()));
                accepted += 1;
            }
            Err(e) => assert!(!e.to_string().contains('\n'), "{e}"),
        }
        // Some file systems wait for the disk when a file is replaced, not when it is gone before.
        std::fs::remove_file(path).unwrap();
    };
    for (name, bytes) in &files {
        for end in 0..bytes.len() {
            attempt(name, &bytes[..end]);
        }
        for at in 0..bytes.len() {
            for value in [bytes[at] ^ 1, bytes[at] ^ 0x80, b'9', b'-', b' ', 0, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] = value;
                attempt(name, &damaged);
            }
        }
    }
    assert!(accepted > 100, "small damage to a coordinate is no error: {accepted}");
}

/// Folder of real scenes, which need not be there.
fn shared_scenes() -> Option<PathBuf> {
    let folder = std::env::var_os("PHR_SCENES")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes"), PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var_os("PHR_SCENES").is_none(), "PHR_SCENES: no folder {}", folder.display());
    eprintln!("skipped: no folder {} (set PHR_SCENES)", folder.display());
    None
}

#[test]
fn real_scenes_have_their_stated_size() {
    let Some(folder) = shared_scenes() else { return };
    for (name, triangles, vertices) in
        [("bunny_144k", 144_046, 72_027), ("brain_icbm152", 163_840, 81_924), ("duplex", 246_888, 136_491)]
    {
        let path = folder.join(format!("{name}.ply.zst"));
        if !path.is_file() {
            eprintln!("skipped: no {}", path.display());
            continue;
        }
        let scene = load(&path).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((scene.mesh.len(), scene.mesh.vertices().len()), (triangles, vertices), "{name}");
        assert_eq!((scene.name.as_str(), scene.dropped.total(), scene.views.len()), (name, 0, 3));
    }
}
