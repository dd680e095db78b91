//! Trees that follow a mesh that moves: refitted, refined again from a refitted auxiliary tree, merged from a
//! static part's and a dynamic one's. In every frame the tree is whole, the same at any number of threads, and
//! gives the hits of a tree built afresh.

use phr::builders::{
    self, AuxiliaryConfig, AuxiliaryTree, BinnedSahConfig, Builder as _, Extensions, MergedPhr, Phr,
    PhrConfig, RefitError,
};
use phr::bvh::{Bvh4, Bvh8, Child, Invalid, Link, WideBvh, WideNode};
use phr::geometry::{Hit, Mesh, Ray, Tracer};
use phr::scene::{self, Animation};
use phr::trace::{BvhTracer, PathSettings, RayKind, record, verify};

const SAH: AuxiliaryTree = AuxiliaryTree::BinnedSah(BinnedSahConfig::DEFAULT);

fn without_presplit(config: PhrConfig) -> PhrConfig {
    let auxiliary = AuxiliaryConfig { presplit: None, ..config.extensions.auxiliary };
    PhrConfig { extensions: Extensions { auxiliary, ..config.extensions }, ..config }
}

/// PHR's presets, and one over another auxiliary tree.
fn configs() -> Vec<PhrConfig> {
    let over_sah =
        PhrConfig { extensions: Extensions { auxiliary_tree: SAH, ..Extensions::NONE }, ..PhrConfig::FAST };
    let own = [PhrConfig::FAST, PhrConfig::HQ, PhrConfig::SPEED, PhrConfig::QUALITY];
    own.into_iter().map(without_presplit).chain([over_sah]).collect()
}

/// The mesh of an animation at times from calm to the end, and back.
fn frames(animation: &Animation) -> impl Iterator<Item = Mesh> + '_ {
    [0.0, 0.1, 0.5, 1.0, 0.0].into_iter().map(|time| {
        let mut mesh = animation.scene.mesh.clone();
        mesh.move_vertices(&animation.vertices(time)).unwrap();
        mesh
    })
}

fn on_threads<T: Send>(threads: usize, f: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(f)
}

/// The tree is whole, and its hits are those of a tree built afresh.
#[track_caller]
fn check<const N: usize>(tree: &WideBvh<N>, mesh: &Mesh, rays: &[Ray], what: &str) {
    tree.validate(mesh).unwrap_or_else(|invalid| panic!("{what}: {invalid}"));
    let fresh = builders::by_name::<4>("phr-fast").unwrap().build(mesh).tree;
    let hits = |tracer: &dyn Tracer| {
        let mut hits = vec![Hit::MISS; rays.len()];
        tracer.closest(rays, &mut hits);
        hits
    };
    let verdict =
        verify::compare_closest(mesh, rays, &hits(&BvhTracer::new(&fresh)), &hits(&BvhTracer::new(tree)));
    assert!(verdict.is_ok(), "{what}: {verdict}");
}

/// Rays of an animation's first view, over a tree of the mesh.
fn rays(animation: &Animation, mesh: &Mesh) -> Vec<Ray> {
    let tree = builders::by_name::<4>("lbvh").unwrap().build(mesh).tree;
    let settings = PathSettings { width: 16, height: 16, max_depth: 4, seed: 3 };
    let batches = record(&BvhTracer::new(&tree), mesh, &animation.scene.views[0], &settings).batches;
    RayKind::ALL.iter().flat_map(|&kind| batches.get(kind).to_vec()).collect()
}

#[test]
fn refitted_and_refined_trees_follow_every_scene() {
    for animated in scene::animated() {
        let animation = animated.generate(5000);
        let mut wide = ["lbvh", "ploc", "phr-fast", "phr-quality", "phr-best"].map(|name| {
            let mesh = &animation.scene.mesh;
            let four = builders::by_name::<4>(name).unwrap().build(mesh).tree;
            (name, four, builders::by_name::<8>(name).unwrap().build(mesh).tree)
        });
        let mut refining: Vec<Phr<8>> = configs()
            .into_iter()
            .map(|config| {
                let mut builder = Phr::new("refining", config).unwrap();
                builder.build(&animation.scene.mesh);
                builder
            })
            .collect();
        for (frame, mesh) in frames(&animation).enumerate() {
            let rays = rays(&animation, &mesh);
            for (name, four, eight) in &mut wide {
                let what = format!("{} {frame} {name} refitted", animated.name);
                let mut alone = four.clone();
                on_threads(3, || four.refit(&mesh)).unwrap();
                on_threads(1, || alone.refit(&mesh)).unwrap();
                assert!(*four == alone, "{what}");
                eight.refit(&mesh).unwrap();
                check(four, &mesh, &rays, &what);
                check(eight, &mesh, &rays, &what);
            }
            for (i, builder) in refining.iter_mut().enumerate() {
                let what = format!("{} {frame} refined {i}", animated.name);
                let tree = on_threads(2, || builder.refit(&mesh)).unwrap().tree;
                assert!(tree == on_threads(1, || builder.refit(&mesh)).unwrap().tree, "{what}");
                check(&tree, &mesh, &rays, &what);
            }
        }
    }
}

#[test]
fn a_mesh_that_has_not_moved_has_the_tree_that_was_built() {
    let mesh = scene::scalable(20_000, 1).mesh;
    for config in configs() {
        let mut builder = Phr::<4>::new("refining", config).unwrap();
        let built = builder.build(&mesh);
        let refined = builder.refit(&mesh).unwrap();
        assert!(refined.tree == built.tree && refined.counts == built.counts, "{config:?}");
        assert_eq!(refined.phases[0].name, "auxiliary refit");
        builder.recycle(built.tree);
        assert!(builder.refit(&mesh).unwrap().tree == refined.tree, "in used memory");
    }
    // Without triangles that were split, boxes are those of the triangles.
    for name in ["lbvh", "ploc", "aac"] {
        let built = builders::by_name::<8>(name).unwrap().build(&mesh).tree;
        let mut refitted = built.clone();
        refitted.refit(&mesh).unwrap();
        assert!(refitted == built, "{name}");
    }
}

#[test]
fn merged_trees_follow_every_scene() {
    for animated in scene::animated() {
        let animation = animated.generate(5000);
        let first = &animation.scene.mesh;
        for (i, config) in configs().into_iter().enumerate() {
            for tree in [AuxiliaryTree::Lbvh, SAH] {
                let mut builder = MergedPhr::<4>::new(config).unwrap();
                builder.keep(first, animation.fixed, tree).unwrap();
                for (frame, mesh) in frames(&animation).enumerate() {
                    let what = format!("{} {frame} merged {i} {tree:?}", animated.name);
                    let built = on_threads(2, || builder.build(&mesh)).unwrap().tree;
                    assert!(built == on_threads(1, || builder.build(&mesh)).unwrap().tree, "{what}");
                    check(&built, &mesh, &rays(&animation, &mesh), &what);
                    builder.recycle(built);
                }
            }
        }
    }
}

#[test]
fn either_part_may_be_empty_or_of_one_triangle() {
    let mesh = scene::scalable(3000, 1).mesh;
    let empty = Mesh::new(Vec::new(), Vec::new()).unwrap().0;
    for config in configs() {
        let plain = Phr::<8>::new("plain", config).unwrap().build(&mesh).tree;
        let mut builder = MergedPhr::<8>::new(config).unwrap();
        assert!(builder.build(&mesh).unwrap().tree == plain, "nothing was kept");
        for kept in [0, 1, 2, 1500, 2999, 3000] {
            builder.keep(&mesh, kept, config.extensions.auxiliary_tree).unwrap();
            for _ in 0..2 {
                let tree = builder.build(&mesh).unwrap().tree;
                assert_eq!(tree.validate(&mesh), Ok(()), "{kept}");
                assert!(tree == plain || !(kept == 0 || kept == 3000), "the whole is one part");
                builder.recycle(tree);
            }
        }
        assert_eq!(
            builder.build(&empty).unwrap_err(),
            RefitError::Triangles { tree: 3000, mesh: 0 },
            "fewer than the static part"
        );
        assert!(builder.keep(&empty, 1, AuxiliaryTree::Lbvh).is_err());
        builder.keep(&empty, 0, AuxiliaryTree::Lbvh).unwrap();
        assert!(builder.build(&empty).unwrap().tree == Bvh8::default());
        assert!(builder.build(&mesh).unwrap().tree == plain, "another mesh, of which nothing is static");
    }
}

#[test]
fn the_dynamic_part_may_grow_and_shrink() {
    let mesh = scene::scalable(6000, 1).mesh;
    let of = |triangles: usize| {
        Mesh::new(mesh.vertices().to_vec(), mesh.triangles()[..triangles].to_vec()).unwrap().0
    };
    let mut builder = MergedPhr::<4>::new(PhrConfig::SPEED).unwrap();
    builder.keep(&mesh, 2000, SAH).unwrap();
    for triangles in [2000, 6000, 2001, 3000] {
        let mesh = of(triangles);
        assert_eq!(builder.build(&mesh).unwrap().tree.validate(&mesh), Ok(()), "{triangles}");
    }
}

#[test]
fn parts_may_collapse_to_points_and_unfold_again() {
    let animation = scene::animated_by_name("parade").unwrap().generate(4000);
    let mesh = &animation.scene.mesh;
    let rays = rays(&animation, mesh);
    type Motion = fn(usize, [f32; 3]) -> [f32; 3];
    let motions: [(&str, Motion); 6] = [
        ("all to a point", |_, _| [1.0, 2.0, 3.0]),
        ("half to a point", |i, v| if i % 4000 < 2000 { [5.0; 3] } else { v }),
        ("to a plane", |_, [x, _, z]| [x, 0.0, z]),
        ("to a line", |_, [x, _, _]| [x, x, -x]),
        ("far away", |_, v| v.map(|x| x * 1e12)),
        ("back", |_, v| v),
    ];
    let mut wide = builders::by_name::<4>("phr-hq").unwrap().build(mesh).tree;
    let mut refining: Vec<Phr<4>> =
        configs().into_iter().map(|config| Phr::new("refining", config).unwrap()).collect();
    refining.iter_mut().for_each(|builder| drop(builder.build(mesh)));
    let mut merged = MergedPhr::<4>::new(PhrConfig::QUALITY).unwrap();
    for (name, motion) in motions {
        let mut moved = mesh.clone();
        let vertices: Vec<[f32; 3]> =
            mesh.vertices().iter().enumerate().map(|(i, &vertex)| motion(i, vertex)).collect();
        moved.move_vertices(&vertices).unwrap();
        wide.refit(&moved).unwrap();
        check(&wide, &moved, &rays, name);
        for builder in &mut refining {
            check(&builder.refit(&moved).unwrap().tree, &moved, &rays, name);
        }
        // What moved is as good a static part.
        merged.keep(&moved, 1000, SAH).unwrap();
        check(&merged.build(&moved).unwrap().tree, &moved, &rays, name);
    }
}

#[test]
fn other_meshes_and_trees_that_are_none_are_refused() {
    let mesh = scene::scalable(2000, 1).mesh;
    let other = scene::scalable(2001, 1).mesh;
    let tree = builders::by_name::<4>("lbvh").unwrap().build(&mesh).tree;
    let mut refitted = tree.clone();
    assert_eq!(refitted.refit(&other), Err(RefitError::Triangles { tree: 2000, mesh: 2001 }));
    assert!(refitted == tree, "nothing was changed");
    assert_eq!(Bvh4::default().refit(&Mesh::new(vec![], vec![]).unwrap().0), Ok(()));

    let (index, slot) = (0..tree.nodes.len())
        .find_map(|i| Some((i, tree.nodes[i].links.iter().position(|link| link.is_inner())?)))
        .unwrap();
    for (link, what) in
        [(tree.root, "node"), (Link::inner(1 << 20), "node"), (Link::leaf(1 << 20, 2), "block")]
    {
        let mut malformed = tree.clone();
        malformed.nodes[index].links[slot] = link;
        let error = malformed.refit(&mesh).unwrap_err();
        assert!(matches!(&error, RefitError::Malformed(Invalid::Link { what: found, .. }) if *found == what));
    }
    assert!(matches!(tree.root.get(), Child::Inner(_)));

    // What is never reached leads anywhere.
    let mut longer = tree.clone();
    let mut node = WideNode::EMPTY;
    node.links[0] = Link::inner(1 << 20);
    longer.nodes.push(node);
    assert_eq!(longer.refit(&mesh), Ok(()));
    let mut gapped = tree.clone();
    let full = tree.blocks.iter().position(|block| block.ids().count() == 4).unwrap();
    gapped.blocks[full].prims[0] = u32::MAX;
    assert_eq!(gapped.refit(&mesh), Err(RefitError::Malformed(Invalid::Block(full))));

    let mut builder = Phr::<4>::new("refining", without_presplit(PhrConfig::SPEED)).unwrap();
    assert_eq!(builder.refit(&mesh).unwrap_err(), RefitError::Triangles { tree: 0, mesh: 2000 });
}
