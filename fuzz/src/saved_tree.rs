//! Saved trees: refused in one line, or a tree over the mesh that answers rays. Every checksum agrees while the
//! crate is fuzzed, so that what is behind them is reached.

use phr::bvh::{Bvh4, Bvh8, Statistics};
use phr::geometry::{Mesh, Ray};
use phr::{Bvh, BvhConfig};
use std::cell::OnceCell;

struct Place {
    folder: tempfile::TempDir,
    mesh: Mesh,
    whole: Vec<u8>,
}

thread_local! {
    static PLACE: OnceCell<Place> = const { OnceCell::new() };
}

fn place() -> Place {
    let folder = tempfile::tempdir().unwrap();
    let mesh = phr::scene::scalable(60, 1).mesh;
    let path = folder.path().join("whole");
    Bvh::build(&mesh, &BvhConfig::default()).unwrap().save(&mesh, &path).unwrap();
    let whole = std::fs::read(path).unwrap();
    Place { folder, mesh, whole }
}

/// A whole tree with some bytes changed, pairs of a place and a byte, cut to a length: whether it is read.
pub fn check(length: Option<u16>, changes: &[(u16, u8)]) -> bool {
    PLACE.with(|known| {
        let Place { folder, mesh, whole } = known.get_or_init(place);
        let mut bytes = whole.clone();
        for &(at, byte) in changes {
            let length = bytes.len();
            bytes[at as usize % length] = byte;
        }
        bytes.truncate(length.map_or(usize::MAX, usize::from));
        let path = folder.path().join("x");
        std::fs::write(&path, bytes).unwrap();
        // Boxes and corners may be anything here: what looks at them says so and does not panic.
        if let Ok(tree) = Bvh4::load(mesh, &path) {
            let _ = (tree.validate(mesh), Statistics::of(&tree, mesh));
        }
        if let Ok(tree) = Bvh8::load(mesh, &path) {
            let _ = (tree.validate(mesh), Statistics::of(&tree, mesh));
        }
        match Bvh::load(mesh, &path) {
            Ok(bvh) => {
                let ray = Ray {
                    org: [0.0; 3].into(),
                    tnear: 0.0,
                    dir: [1.0, 0.3, 0.2].into(),
                    tfar: f32::INFINITY,
                };
                // Boxes and corners may be anything here: the answer is of some triangle, or none.
                let mut hits = [None; 9];
                bvh.intersect_batch(&[ray; 9], &mut hits);
                for hit in hits.into_iter().chain([bvh.intersect(&ray)]).flatten() {
                    assert!((hit.prim as usize) < mesh.len(), "{hit:?}");
                }
                bvh.occluded(&ray);
                true
            }
            Err(error) => {
                assert_eq!(error.to_string().lines().count(), 1, "{error}");
                false
            }
        }
    })
}
