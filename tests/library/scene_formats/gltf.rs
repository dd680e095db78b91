//! glTF and GLB: meshes in the places of their nodes, what is no triangle counted.

use super::*;
use std::io::Write;

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
    let remarks = scene.remarks();
    assert!(remarks[0].contains("1 points, 3 lines, 2 without"), "{remarks:?}");
    assert_eq!(remarks[1..], ["x.glb: mesh 0, primitive 5: no POSITION"]);
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
    assert_eq!((scene.mesh.len(), scene.mesh.vertices().len()), (3000 * 2, 4), "all in one place");
}

/// Some files have one list of vertices for all their meshes.
#[test]
fn meshes_in_one_place_share_their_vertices() {
    let scene = read(
        "x.glb",
        changed(|d| {
            let mesh = d["meshes"][0].clone();
            d["meshes"] = vec![mesh; 3].into();
            let node = |mesh: u32, x: f32| json!({"mesh": mesh, "translation": [x, 0, 0]});
            d["nodes"] = json!([node(0, 0.0), node(1, 0.0), node(2, 5.0), node(1, 5.0), node(0, 0.0)]);
            d["scenes"] = json!([{"nodes": [0, 1, 2, 3, 4]}]);
        }),
    );
    let moved: Vec<_> = two().into_iter().map(|t| t.map(|[x, y, z]| [x + 5.0, y, z])).collect();
    assert_eq!(corners(&scene), [two(), two(), moved.clone(), moved, two()].concat());
    assert_eq!(scene.mesh.vertices().len(), 3 * 4);
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
        (
            changed(|d| d["accessors"][0]["count"] = 5.into()),
            "accessor 0, bufferView 0: ends before its last",
        ),
        (changed(|d| d["accessors"][0]["count"] = (1u64 << 60).into()), "MiB or more of memory"),
        (changed(|d| d["accessors"][1]["count"] = (1u64 << 60).into()), "MiB or more of memory"),
        (changed(|d| d["accessors"][0]["type"] = "VEC2".into()), "accessor 0: positions that are no vectors"),
        (changed(|d| d["accessors"][0]["type"] = "VEC9".into()), "accessor 0: of an unknown type"),
        (changed(|d| d["accessors"][1]["componentType"] = 5126.into()), "accessor 1: indices that are no"),
        (
            changed(|d| d["bufferViews"][0]["byteOffset"] = u64::MAX.into()),
            "accessor 0, bufferView 0: beyond the end",
        ),
        (
            changed(|d| d["bufferViews"][0]["byteStride"] = 4.into()),
            "accessor 0, bufferView 0: a stride shorter",
        ),
        (changed(|d| d["buffers"][0]["byteLength"] = 4096.into()), "buffer 0: has 92 bytes of 4096"),
        (
            changed(|d| d["buffers"][0]["uri"] = "none.bin".into()),
            "none.bin: No such file or directory (os error 2); put",
        ),
        (changed(|d| d["buffers"][0]["uri"] = "http://a.b/c".into()), "http://a.b/c is not a file"),
        (changed(|d| d["buffers"][0]["uri"] = "a/..%2f../c".into()), "outside the scene's folder"),
        (changed(|d| d["buffers"][0]["uri"] = "/etc/hostname".into()), "outside the scene's folder"),
        (changed(|d| d["buffers"][0]["uri"] = "data:;base64,*".into()), "buffer 0: a data URI"),
        (changed(|d| d["meshes"][0]["primitives"][0]["mode"] = 1.into()), "no usable triangle"),
        (
            changed(|d| d["meshes"][0]["primitives"][0]["attributes"] = json!({"NORMAL": 0})),
            "mesh 0, primitive 0: no POSITION; export it with",
        ),
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
    let told = "x.glb: 1 triangle dropped: 1 with indices out of range, first: mesh 0, primitive 0, triangle 1; \
                export the file again";
    assert_eq!(scene.remarks(), [told]);
}
