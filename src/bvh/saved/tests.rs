use super::*;
use crate::builders::Geometry as _;
use crate::bvh::{Bvh4, Bvh8, Link, TriangleBlock, WideNode};
use crate::geometry::Mesh;

/// A sheet of `count` triangles.
fn mesh(count: usize) -> Mesh {
    let vertices = (0..count as u32 + 2).map(|i| [(i / 2) as f32, (i % 2) as f32, (i % 7) as f32]).collect();
    Mesh::new(vertices, (0..count as u32).map(|i| [i, i + 1, i + 2]).collect()).unwrap().0
}

/// A chain of nodes, each with a leaf of up to four triangles and the next node.
fn chain(mesh: &Mesh) -> Bvh4 {
    let ids: Vec<u32> = (0..mesh.len() as u32).collect();
    let blocks: Vec<TriangleBlock> = ids.chunks(4).map(|ids| mesh.block_of(ids)).collect();
    let mut nodes = vec![WideNode::<4>::EMPTY; blocks.len()];
    for (i, node) in nodes.iter_mut().enumerate() {
        node.set(0, mesh.bounds(), Link::leaf(i, 1));
        if i + 1 < blocks.len() {
            node.set(1, mesh.bounds(), Link::inner(i + 1));
        }
    }
    Bvh4 { root: Link::inner(0), bounds: mesh.bounds(), nodes, blocks }
}

#[test]
fn trees_survive_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.phrtree");
    let mesh = mesh(50);
    let tree = chain(&mesh);
    tree.save(&mesh, "by-hand", &path).unwrap();
    assert_eq!(Bvh4::load(&mesh, &path).unwrap(), tree);
    let header = header_of(path.to_str().unwrap()).unwrap();
    assert_eq!((header.width, header.triangles, header.builder.as_str()), (4, 50, "by-hand"));
    assert_eq!((header.mesh, header.blocks), (mesh.fingerprint(), 13));
    assert_eq!(std::fs::metadata(&path).unwrap().len(), 128 + 13 * (128 + 160));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no part file is left");
    let none = Mesh::new(vec![], vec![]).unwrap().0;
    Bvh8::default().save(&none, "a name that is longer than thirty-two bytes", &path).unwrap();
    assert_eq!(Bvh8::load(&none, &path).unwrap(), Bvh8::default());
    assert_eq!(header_of(&path).unwrap().builder.len(), 32);
}

/// The file may be mapped: after the header it is what goes to a GPU, nodes and blocks, at multiples of their sizes.
#[test]
fn a_file_is_laid_out_as_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.phrtree");
    let mesh = mesh(50);
    let four = chain(&mesh);
    four.save(&mesh, "by-hand", &path).unwrap();
    assert_eq!(std::fs::read(&path).unwrap()[128..], [four.node_bytes(), four.block_bytes()].concat());
    let eight = crate::builders::by_name::<8>("lbvh").unwrap().build(&mesh).tree;
    eight.save(&mesh, "lbvh", &path).unwrap();
    assert_eq!(std::fs::read(&path).unwrap()[128..], [eight.node_bytes(), eight.block_bytes()].concat());
}

/// What is read from an open file is the tree that was there, whatever takes its place.
#[test]
fn an_open_tree_stays_what_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.phrtree");
    let mesh = mesh(50);
    let tree = chain(&mesh);
    tree.save(&mesh, "by-hand", &path).unwrap();
    let open = SavedTree::open(&path).unwrap();
    let eight = crate::builders::by_name::<8>("lbvh").unwrap().build(&mesh).tree;
    eight.save(&mesh, "lbvh", &path).unwrap();
    assert_eq!(Bvh4::read(&mesh, open).unwrap(), tree);
    assert_eq!(Bvh8::load(&mesh, &path).unwrap(), eight);
}

/// Five leaves of one triangle: no file of it could be loaded.
#[test]
fn a_tree_of_too_many_blocks_is_not_saved() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = mesh(1);
    let mut tree = Bvh8 { bounds: mesh.bounds(), root: Link::inner(0), ..Bvh8::default() };
    tree.nodes.push(WideNode::EMPTY);
    for slot in 0..5 {
        tree.blocks.push(mesh.block_of(&[0]));
        tree.nodes[0].set(slot, mesh.bounds(), Link::leaf(slot, 1));
    }
    let path = folder.path().join("x.phrtree");
    assert!(matches!(tree.save(&mesh, "by-hand", &path), Err(SavedError::TooMany { blocks: 5, .. })));
    assert!(!path.exists());
}

#[test]
fn other_meshes_and_widths_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.phrtree");
    let mesh = mesh(9);
    chain(&mesh).save(&mesh, "by-hand", &path).unwrap();
    let said = |result: Result<(), SavedError>| result.unwrap_err().to_string();
    let moved =
        Mesh::new(mesh.vertices().iter().map(|v| v.map(|x| x + 1.0)).collect(), mesh.triangles().to_vec());
    let message = said(Bvh4::load(&moved.unwrap().0, &path).map(|_| ()));
    assert!(message.contains("the tree of another mesh (9 triangles") && message.contains(';'), "{message}");
    assert!(said(Bvh8::load(&mesh, &path).map(|_| ())).contains("a tree of 4 children per node, not 8"));
    assert!(said(header_of(folder.path().join("none")).map(|_| ())).contains("none: No such file"));
    assert!(said(header_of(folder.path()).map(|_| ())).contains("not a regular file; give a file that"));
    for content in ["", "o scene\n", "v 0 0 0\n".repeat(99).as_str()] {
        std::fs::write(folder.path().join("x.obj"), content).unwrap();
        let message = said(header_of(folder.path().join("x.obj")).map(|_| ()));
        assert!(
            message
                .ends_with("x.obj: not a saved tree; give a file that `Bvh::save` or `phr build -o` wrote"),
            "{message}"
        );
    }
    let whole = std::fs::read(&path).unwrap();
    for length in [1, 7, 8, 100] {
        std::fs::write(folder.path().join("cut"), &whole[..length]).unwrap();
        let message = said(header_of(folder.path().join("cut")).map(|_| ()));
        assert!(message.ends_with("cut: shorter than a saved tree; save the tree again"), "{message}");
    }
    assert!(said(chain(&mesh).save(&mesh, "", folder.path().join("no/x"))).contains("No such file"));
}

/// Of several chunks each of nodes and blocks, on any number of threads.
#[test]
fn chunks_follow_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.phrtree");
    let mesh = mesh(4 * (2 * CHUNK + 77));
    let tree = crate::builders::by_name::<4>("lbvh").unwrap().build(&mesh).tree;
    assert!(tree.blocks.len() > CHUNK && tree.nodes.len() > CHUNK / 2);
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            tree.save(&mesh, "lbvh", &path).unwrap();
            assert_eq!(Bvh4::load(&mesh, &path).unwrap(), tree);
        });
    }
    let mut bytes = std::fs::read(&path).unwrap();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    std::fs::write(&path, bytes).unwrap();
    assert!(Bvh4::load(&mesh, &path).unwrap_err().to_string().contains("damaged nodes or blocks"));
}

/// Any byte changed and any end cut off.
#[test]
fn damage_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.phrtree");
    let mesh = mesh(9);
    chain(&mesh).save(&mesh, "by-hand", &path).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let load = |bytes: &[u8]| {
        // Some file systems wait for the disk when a file is replaced, not when it is gone before.
        std::fs::remove_file(&path).unwrap();
        std::fs::write(&path, bytes).unwrap();
        Bvh4::load(&mesh, &path)
    };
    for at in 0..whole.len() {
        for bit in [1, 0x80] {
            let mut damaged = whole.clone();
            damaged[at] ^= bit;
            let message = load(&damaged).expect_err(&format!("byte {at}")).to_string();
            assert!(!message.contains('\n') && message.contains("x.phrtree"), "{message}");
        }
        assert!(load(&whole[..at]).is_err(), "{at} bytes");
    }
    let mut older = whole.clone();
    older[8] = 1;
    let message = load(&older).unwrap_err().to_string();
    assert!(message.contains("version 1, this program reads 2; save the tree again"), "{message}");
    assert!(load(&[&whole[..], b"\0"].concat()).is_err(), "a byte too many");
}

/// Whole files of trees that kernels must not follow.
#[test]
fn links_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.phrtree");
    let mesh = mesh(40);
    let good = chain(&mesh);
    let mut bad: Vec<Bvh4> = vec![good.clone(); 7];
    bad[0].nodes[3].links[1] = Link::inner(0);
    bad[1].nodes[3].links[0] = Link::leaf(9, 2);
    bad[2].nodes[3].links[1] = Link::EMPTY;
    bad[3].blocks[2].prims[0] = 40;
    bad[4].blocks[2].prims[0] = 0;
    bad[5].root = Link::inner(99);
    // The bits of a link have room for eight blocks.
    let one_more = Link::leaf(0, 2).bits() - Link::leaf(0, 1).bits();
    bad[6].root = Link::from_bits(Link::leaf(0, 7).bits() + one_more);
    for (i, tree) in bad.iter().enumerate() {
        tree.save(&mesh, "by-hand", &path).unwrap();
        let result = Bvh4::load(&mesh, &path);
        assert!(matches!(result, Err(SavedError::Invalid { .. })), "{i}: {result:?}");
    }
    assert_eq!(bad[6].validate(&mesh).unwrap_err(), Invalid::LongLeaf(0));
    let fewer = self::mesh(39);
    let mut gapped = chain(&fewer);
    gapped.blocks[9].prims = [36, u32::MAX, 37, 38];
    assert_eq!(gapped.validate_links(fewer.len()), Err(Invalid::Block(9)));
    let deep = self::mesh(4 * 200);
    chain(&deep).save(&deep, "by-hand", &path).unwrap();
    assert!(Bvh4::load(&deep, &path).unwrap_err().to_string().contains("deeper than"));
}
