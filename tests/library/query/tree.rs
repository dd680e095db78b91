//! The tree behind a `Bvh`: built, rebuilt, fitted, saved, loaded, given back.

use super::{DOWN, both, check_batch, plain, triangles};
use crate::trace_support::*;
use phr::builders::RefitError;
use phr::bvh::saved::{SavedError, header_of};
use phr::bvh::{Bvh4, Invalid, Link, TriangleBlock, WideBvh, WideNode};
use phr::geometry::{Aabb, Mesh, Ray};
use phr::glam::Vec3A;
use phr::query::BvhError;
use phr::trace::verify::compare_closest;
use phr::trace::{BruteForce, BvhTracer};
use phr::{Bvh, BvhConfig};

#[test]
fn the_tree_is_given_back() {
    let [four, eight] = triangles();
    let trees = (four.as_bvh4().cloned(), eight.as_bvh8().cloned());
    assert!(trees.0.is_some() && trees.1.is_some());
    assert_eq!((four.into_bvh4().ok(), eight.into_bvh8().ok()), trees);
    let [four, eight] = triangles();
    let (four, eight) = (four.into_bvh8().unwrap_err(), eight.into_bvh4().unwrap_err());
    assert_eq!((four.as_bvh4().cloned(), eight.as_bvh8().cloned()), trees);
    assert!(four.occluded(&DOWN) && eight.occluded(&DOWN));
}

#[test]
fn a_tree_is_rebuilt_in_its_memory() {
    let (folder, rays) = (tempfile::tempdir().unwrap(), rays(&soup(900, 1), 500, 2));
    let path = folder.path().join("x.phrtree");
    for (builder, width) in [("phr-turbo", 8), ("phr-best", 4), ("lbvh", 8)] {
        let config = BvhConfig::new(builder, width);
        let first = soup(500, 3);
        let built = Bvh::build(&first, &config).unwrap();
        built.save(&first, &path).unwrap();
        for mut bvh in [built, Bvh::load(&first, &path).unwrap()] {
            for triangles in [900, 0, 500, 501] {
                let mesh = soup(triangles, triangles as u64);
                bvh.rebuild(&mesh).unwrap();
                let fresh = Bvh::build(&mesh, &config).unwrap();
                assert_eq!((bvh.as_bvh4(), bvh.as_bvh8()), (fresh.as_bvh4(), fresh.as_bvh8()));
                assert_eq!(
                    (bvh.len(), bvh.bytes(), bvh.builder()),
                    (triangles, fresh.bytes(), Some(builder))
                );
                assert!(rays.iter().all(|ray| bvh.intersect(ray) == fresh.intersect(ray)));
            }
        }
    }
}

#[test]
fn a_tree_of_an_unknown_builder_is_not_rebuilt() {
    let (folder, mesh) = (tempfile::tempdir().unwrap(), soup(500, 3));
    let path = folder.path().join("x.phrtree");
    median_tree::<4>(&mesh, 4).save(&mesh, "median", &path).unwrap();
    let of_median = Bvh::load(&mesh, &path).unwrap();
    // A file has room for 32 bytes of a name.
    median_tree::<4>(&mesh, 4).save(&mesh, "phr-hq[presplit=none+max_cut=4096]", &path).unwrap();
    let of_long_name = Bvh::load(&mesh, &path).unwrap();
    let [of_nobody, _] = both(&mesh);
    let told = [
        (of_median, "no builder is called median; "),
        (of_long_name, "the builder of this tree is not told"),
        (of_nobody, "the builder of this tree is not told"),
    ];
    for (mut bvh, words) in told {
        let before = bvh.as_bvh4().cloned();
        let error = bvh.rebuild(&soup(300, 4)).unwrap_err().to_string();
        assert!(error.starts_with(words) && !error.contains('\n'), "{error}");
        assert_eq!((bvh.as_bvh4().cloned(), bvh.len()), (before, 500));
    }
}

#[test]
fn a_tree_is_fitted_to_a_mesh_that_has_moved() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.phrtree");
    let still = soup(700, 5);
    let mut moved = still.clone();
    let shift = |&[x, y, z]: &[f32; 3]| [2.0 * x + 0.3 * y * z, y - 1.0, z + 0.1 * x];
    moved.move_vertices(&still.vertices().iter().map(shift).collect::<Vec<_>>()).unwrap();
    let rays = rays(&moved, 2000, 6);
    let reference = closest(&BruteForce(&moved), &rays);
    for mut bvh in both(&still) {
        bvh.refit(&moved).unwrap();
        let hits = plain(&check_batch(&bvh, &rays));
        let verdict = compare_closest(&moved, &rays, &reference, &hits);
        assert!(verdict.is_ok(), "{verdict}");
        assert_eq!(bvh.bounds(), moved.bounds());
        assert!(bvh.save(&still, &path).is_err());
        bvh.save(&moved, &path).unwrap();
        let before = (bvh.as_bvh4().cloned(), bvh.as_bvh8().cloned());
        assert_eq!(bvh.refit(&soup(701, 5)), Err(RefitError::Triangles { tree: 700, mesh: 701 }));
        assert_eq!((bvh.as_bvh4().cloned(), bvh.as_bvh8().cloned()), before);
    }
}

#[test]
fn a_loaded_tree_answers_as_the_saved_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.phrtree");
    let mesh = soup(500, 3);
    let rays = rays(&mesh, 1000, 4);
    for bvh in both(&mesh) {
        bvh.save(&mesh, &path).unwrap();
        let loaded = Bvh::load(&mesh, &path).unwrap();
        assert_eq!(loaded.bytes(), bvh.bytes());
        assert!(rays.iter().all(|ray| loaded.intersect(ray) == bvh.intersect(ray)));
        let other = Bvh::load(&soup(500, 5), &path);
        assert!(matches!(other, Err(SavedError::OtherMesh { .. })), "{other:?}");
        let more = [mesh.triangles(), &mesh.triangles()[..1]].concat();
        let more = Mesh::new(mesh.vertices().to_vec(), more).unwrap().0;
        for other in [soup(500, 5), more] {
            let refused = bvh.save(&other, &path).unwrap_err().to_string();
            assert!(refused.contains("the tree is of another mesh") && !refused.contains('\n'), "{refused}");
        }
    }
}

#[test]
fn a_tree_knows_its_builder_also_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.phrtree");
    let mesh = soup(500, 3);
    for (builder, width) in [("phr-quality", 8), ("phr-hq-clip", 4)] {
        let bvh = Bvh::build(&mesh, &BvhConfig { builder, width }).unwrap();
        bvh.save(&mesh, &path).unwrap();
        assert_eq!(header_of(&path).unwrap().builder, builder);
        for bvh in [bvh, Bvh::load(&mesh, &path).unwrap()] {
            assert_eq!((bvh.builder(), bvh.width()), (Some(builder), width));
            assert_eq!((bvh.len(), bvh.is_empty()), (mesh.len(), false));
        }
    }
    let [foreign, _] = both(&mesh);
    assert_eq!((foreign.builder(), foreign.width(), foreign.len()), (None, 4, mesh.len()));
    foreign.save(&mesh, &path).unwrap();
    assert_eq!(Bvh::load(&mesh, &path).unwrap().builder(), None);
}

/// A tree that answers rays and that `load` would refuse is not saved.
#[test]
fn what_could_not_be_loaded_is_not_saved() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tree");
    let mesh = soup(100, 1);
    let mut with_more = both(&mesh)[0].as_bvh4().unwrap().clone();
    with_more.nodes.push(WideNode::EMPTY);
    let error = Bvh::try_from(with_more).unwrap().save(&mesh, &path).unwrap_err();
    assert!(error.to_string().contains("is never reached; build the tree again"), "{error}");
    // Of triangles 0 and 2 of three.
    let three = self::mesh(
        (0..9u8).map(|i| [f32::from(i % 3), f32::from(i / 3), f32::from(i * i)]).collect(),
        vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]],
    );
    let mut block = TriangleBlock::EMPTY;
    block.set(0, three.corners(0), 0);
    block.set(1, three.corners(2), 2);
    let lacking = Bvh4 { root: Link::leaf(0, 1), bounds: three.bounds(), nodes: vec![], blocks: vec![block] };
    let error = Bvh::try_from(lacking).unwrap().save(&three, &path).unwrap_err();
    assert!(matches!(error, SavedError::Invalid { source: Invalid::Missing(1), .. }), "{error}");
    assert!(!path.exists());
}

/// The box of a whole tree places its instances.
#[test]
fn a_box_that_does_not_hold_its_tree_is_refused() {
    for mesh in [soup(100, 1), soup(3, 1)] {
        let tree = phr::builders::by_name::<8>("lbvh").unwrap().build(&mesh).tree;
        let with = |bounds: Aabb| Bvh::try_from(WideBvh { bounds, ..tree.clone() });
        let Aabb { min, max } = tree.bounds;
        assert!(with(tree.bounds).is_ok() && with(Aabb::new(min - 1.0, max)).is_ok());
        for bounds in [Aabb::EMPTY, Aabb::new(min, max - 0.9 * (max - min)), Aabb::new(min, Vec3A::INFINITY)]
        {
            let error = with(bounds).unwrap_err();
            assert!(error.to_string().contains("its box does not hold"), "{error}");
        }
    }
}

/// The tree is that of the builder of this name and width.
fn check_build<const N: usize>(
    mesh: &Mesh,
    builder: &str,
    rays: &[Ray],
    of: impl Fn(&Bvh) -> Option<&WideBvh<N>>,
) {
    let bvh = Bvh::build(mesh, &BvhConfig { builder, width: N }).unwrap();
    let tree = phr::builders::by_name::<N>(builder).unwrap().build(mesh).tree;
    assert!(of(&bvh) == Some(&tree), "{builder}, {N}-wide");
    let found: Vec<f32> = rays.iter().filter_map(|ray| bvh.intersect(ray)).map(|hit| hit.t).collect();
    let expected = closest(&BvhTracer::new(&tree), rays);
    let expected: Vec<f32> = expected.iter().filter(|hit| hit.is_hit()).map(|hit| hit.t).collect();
    assert!(found == expected && !found.is_empty(), "{builder}, {N}-wide: {found:?} {expected:?}");
    assert_eq!(bvh.bytes(), tree.bytes() + 4 * mesh.len());
}

#[test]
fn a_tree_is_built_by_name() {
    let mesh = soup(300, 1);
    let rays = rays(&mesh, 64, 2);
    for builder in phr::builders::NAMES {
        check_build::<4>(&mesh, builder, &rays, Bvh::as_bvh4);
        check_build::<8>(&mesh, builder, &rays, Bvh::as_bvh8);
    }
    let error = Bvh::build(&mesh, &BvhConfig::new("sah", 4)).unwrap_err();
    assert!(error.to_string().starts_with("no builder is called sah; there are lbvh, "), "{error}");
    let error = Bvh::build(&mesh, &BvhConfig { width: 6, ..BvhConfig::default() }).unwrap_err();
    assert_eq!(error.to_string(), "no tree has nodes of 6 children; give 4 or 8");
}

#[test]
fn malformed_trees_are_refused() {
    let tree = Bvh4 { root: Link::inner(3), ..Bvh4::default() };
    let error = Bvh::try_from(tree).unwrap_err();
    assert!(matches!(&error, BvhError::Malformed(flaw) if flaw.contains("node 3 of 0")), "{error}");
    let mut tree = median_tree::<4>(&soup(5, 1), 4);
    tree.blocks[0].prims[0] = u32::MAX - 1;
    assert!(Bvh::try_from(tree).unwrap_err().to_string().contains("triangle 4294967294 of no mesh"));
}
