//! STL, text or binary.

use super::*;

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
