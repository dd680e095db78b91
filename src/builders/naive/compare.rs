//! The builders against the naive ones.

use super::builders::{clustered_phr, hunt, phr, wide_lbvh};
use super::meshes::{
    beads, clusters, coarse, concentric, geometric, grids, identical, needles, overhanging, scaled, soup,
};
use super::ploc::ploc;
use super::wide::Wide;
use crate::builders::binary::tree::TREELET;
use crate::builders::{
    AuxiliaryConfig, AuxiliaryTree, Build, Builder, ClusteredPhr, ClusteredPhrConfig, Clusters,
    CollapseCosts, Extensions, Hunt, HuntConfig, Lbvh, LocalThreshold, OptimiseConfig, OptimisedPhr,
    OptimisedPhrConfig, Phr, PhrConfig, Ploc, PlocConfig, PresplitConfig,
};
use crate::bvh::WideBvh;
use crate::geometry::Mesh;
use crate::scene::scalable;
use crate::simd::Isa;
use rayon::prelude::*;

/// Configurations that between them use all that there is.
fn configs() -> Vec<(&'static str, PhrConfig)> {
    let paper = AuxiliaryConfig::PAPER;
    let presplit = AuxiliaryConfig { presplit: Some(PresplitConfig::NEEDLES), ..paper };
    let clusters = AuxiliaryConfig { clusters: Some(Clusters { most: 20, area: 3e-2 }), ..paper };
    let local_threshold = Some(LocalThreshold { references: 30, area: 1e-2 });
    let collapse = Some(CollapseCosts { node: 1.0, leaf: 0.3, block: 0.4, max_leaf: 20 });
    let none = Extensions::NONE;
    let fast = |extensions| PhrConfig { extensions, ..PhrConfig::FAST };
    let auxiliary = |auxiliary| fast(Extensions { auxiliary, ..none });
    vec![
        ("fast", PhrConfig::FAST),
        ("hq", PhrConfig::HQ),
        ("filled cut", PhrConfig { max_cut: 64, ..fast(Extensions { cut_share: Some(0.1), ..none }) }),
        ("auxiliary leaves", auxiliary(AuxiliaryConfig { auxiliary_leaf: Some(4), ..paper })),
        ("large leaves", PhrConfig { max_leaf: 28, ..PhrConfig::FAST }),
        ("presplit", auxiliary(presplit)),
        ("bucket sort", auxiliary(AuxiliaryConfig { bucket_sort: true, ..paper })),
        ("clipped triangles", fast(Extensions { clip_triangles: true, ..none })),
        ("triangle counts", fast(Extensions { triangle_counts: true, ..none })),
        ("clusters", auxiliary(clusters)),
        ("subtree sweep", fast(Extensions { subtree_sweep: Some(256), ..none })),
        ("calibration", auxiliary(AuxiliaryConfig { calibration: Some(0.3), ..clusters })),
        ("local threshold", PhrConfig { delta: 2.0, ..fast(Extensions { local_threshold, ..none }) }),
        ("small spatial splits", PhrConfig { spatial_threshold: 1e-4, ..PhrConfig::FAST }),
        (
            "over PLOC",
            fast(Extensions { auxiliary_tree: AuxiliaryTree::Ploc(PlocConfig { radius: 8 }), ..none }),
        ),
        ("speed", PhrConfig::SPEED),
        ("quality", PhrConfig::QUALITY),
        (
            "cheapest",
            PhrConfig {
                extensions: Extensions { auxiliary: presplit, collapse, subtree_sweep: Some(20), ..none },
                ..PhrConfig::HQ
            },
        ),
        (
            "all",
            PhrConfig {
                spatial_threshold: 1e-6,
                max_references: 4.0,
                ..fast(Extensions {
                    auxiliary: AuxiliaryConfig {
                        auxiliary_leaf: Some(4),
                        clusters: Some(Clusters { most: 40, area: 1e-3 }),
                        calibration: Some(2.0),
                        bucket_sort: true,
                        ..presplit
                    },
                    subtree_sweep: Some(50),
                    clip_triangles: true,
                    local_threshold,
                    collapse,
                    ..none
                })
            },
        ),
    ]
}

/// Cuts that one round of refinement makes, and some that take several.
const HUNT: [HuntConfig; 2] =
    [HuntConfig { cut_length: 50, max_leaf: 8 }, HuntConfig { cut_length: 7, max_leaf: 12 }];

/// Spatial splits of all nodes, among clusters that reach far beyond the planes.
const FAR_BEYOND: ClusteredPhrConfig = ClusteredPhrConfig {
    alpha: 0.5,
    delta: 7.0,
    max_cut: 2048,
    spatial_threshold: 0.0,
    clusters: Clusters { most: 40, area: 0.3 },
    presplit: None,
};

/// The presets; that; the same over pieces of needles; over single blocks; shorter cuts of small clusters; nearly
/// nothing finished; no spatial splits.
const CLUSTERED: [ClusteredPhrConfig; 8] = [
    ClusteredPhrConfig::DRAFT,
    ClusteredPhrConfig::TURBO,
    FAR_BEYOND,
    ClusteredPhrConfig { presplit: Some(PresplitConfig::NEEDLES), ..FAR_BEYOND },
    ClusteredPhrConfig { clusters: Clusters { most: 4, area: 2.0 }, ..FAR_BEYOND },
    ClusteredPhrConfig { max_cut: 64, clusters: Clusters { most: 40, area: 1e-3 }, ..FAR_BEYOND },
    ClusteredPhrConfig { clusters: Clusters { most: 4, area: 0.0 }, ..ClusteredPhrConfig::TURBO },
    ClusteredPhrConfig { spatial_threshold: f32::INFINITY, ..ClusteredPhrConfig::TURBO },
];

/// The default, one whose tasks reach far into others, and the least.
const PLOC: [PlocConfig; 3] = [PlocConfig::DEFAULT, PlocConfig { radius: 100 }, PlocConfig { radius: 1 }];

fn small_meshes() -> Vec<(String, Mesh)> {
    let mut meshes = Vec::new();
    for n in [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 15, 16, 17, 20, 23, 24, 25, 33, 47, 49, 64, 100, 257, 600] {
        let seed = n as u64;
        let size = [0.02, 0.3, 1.0][n % 3];
        meshes.push((format!("soup of {n}"), soup(n, size, seed)));
        meshes.push((format!("{n} needles"), needles(n, seed)));
        meshes.push((format!("{n} on a coarse grid"), coarse(n, [2.0, 5.0, 20.0][n % 3], seed)));
        meshes.push((format!("{n} in clusters"), clusters(n, seed)));
        meshes.push((format!("{n} beads"), beads(n, seed)));
        meshes.push((format!("{n} identical"), identical(n)));
        meshes.push((format!("{n} concentric"), concentric(n)));
        meshes.push((format!("{n} geometric"), geometric(n)));
    }
    // Around the numbers of references that are looked at together.
    for n in [11, 13, 14, 31, 32, 63, 95] {
        meshes.push((format!("soup of {n}"), soup(n, 0.1, 3)));
        meshes.push((format!("{n} on a coarse grid"), coarse(n, 5.0, 3)));
    }
    for scale in [1e-38, 1e-20, 1e-3, 1e9, 1e18] {
        meshes.push((format!("soup of size {scale}"), scaled(500, scale, 5)));
    }
    meshes.push(("grids".to_owned(), grids(12)));
    meshes.push(("overhanging".to_owned(), overhanging()));
    meshes
}

fn large_meshes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("a large soup", soup(5000, 0.02, 1)),
        ("many needles", needles(1800, 2)),
        ("many beads", beads(2500, 6)),
        ("more beads", beads(4500, 7)),
        ("large grids", grids(32)),
        ("a large coarse grid", coarse(6000, 14.0, 3)),
        ("many in clusters", clusters(9000, 4)),
        ("many identical", identical(5000)),
        ("many geometric", geometric(5000)),
        ("a generated scene", scalable(30_000, 1).mesh),
        ("another generated scene", scalable(12_000, 2).mesh),
    ]
}

pub fn assert_same<const N: usize>(tree: &WideBvh<N>, mesh: &Mesh, expected: Option<&Wide>, what: &str) {
    assert_eq!(tree.validate(mesh), Ok(()), "{what}");
    let difference = Wide::difference(Wide::of_tree(tree).as_ref(), expected);
    assert!(difference.is_none(), "{what}, child {}", difference.unwrap());
}

/// Compares all builders at a width on a mesh; returns how many spatial splits were made by the configurations.
fn compare<const N: usize>(what: &str, mesh: &Mesh) -> Vec<u64> {
    let mut spatial_splits = Vec::new();
    for (name, config) in configs() {
        let Build { tree, counts, .. } = Phr::<N>::new("", config).unwrap().build(mesh);
        spatial_splits.push(counts.spatial_splits);
        assert_same(&tree, mesh, phr(mesh, &config, N).as_ref(), &format!("{what}, {name}, width {N}"));
    }
    // Each treelet is widened on its own; nodes over treelets do not reach into them.
    if mesh.len() <= TREELET {
        let tree = Lbvh::<N>::default().build(mesh).tree;
        assert_same(&tree, mesh, wide_lbvh(mesh, N).as_ref(), &format!("{what}, lbvh, width {N}"));
    }
    for config in HUNT {
        let tree = Hunt::<N>::new("", config).unwrap().build(mesh).tree;
        let what = format!("{what}, hunt {}, width {N}", config.cut_length);
        assert_same(&tree, mesh, hunt(mesh, &config, N).as_ref(), &what);
    }
    for config in CLUSTERED {
        let tree = ClusteredPhr::<N>::new("", config).unwrap().build(mesh).tree;
        let what = format!("{what}, clusters of {}, width {N}", config.clusters.most);
        assert_same(&tree, mesh, clustered_phr(mesh, &config, N).as_ref(), &what);
    }
    for config in PLOC {
        let tree = Ploc::<N>::new(config).unwrap().build(mesh).tree;
        let what = format!("{what}, ploc {}, width {N}", config.radius);
        assert_same(&tree, mesh, ploc(mesh, &config, N).as_ref(), &what);
    }
    spatial_splits
}

#[test]
fn small_trees_are_the_naive_ones_node_for_node() {
    small_meshes().par_iter().for_each(|(what, mesh)| {
        compare::<4>(what, mesh);
        compare::<8>(what, mesh);
    });
}

#[test]
fn large_4_wide_trees_are_the_naive_ones_node_for_node() {
    large_trees::<4>();
}

#[test]
fn large_8_wide_trees_are_the_naive_ones_node_for_node() {
    large_trees::<8>();
}

fn large_trees<const N: usize>() {
    let mut spatial_splits = vec![0; configs().len()];
    for (what, mesh) in large_meshes() {
        spatial_splits.iter_mut().zip(compare::<N>(what, &mesh)).for_each(|(sum, n)| *sum += n);
    }
    assert!(spatial_splits.iter().all(|&n| n > 50), "{spatial_splits:?}");
}

/// Costs that are zero or infinite are so for all instructions.
#[test]
fn trees_of_extreme_size_are_the_same_with_any_instructions() {
    for scale in [1e-38, 1e-20, 1e9, 1e18] {
        let mesh = scaled(500, scale, 5);
        same_tree_everywhere::<4>(&format!("soup of size {scale}"), &mesh);
        same_tree_everywhere::<8>(&format!("soup of size {scale}"), &mesh);
    }
}

#[test]
fn trees_are_the_same_with_any_instructions_and_any_number_of_threads() {
    for (what, mesh) in large_meshes() {
        same_tree_everywhere::<4>(what, &mesh);
        same_tree_everywhere::<8>(what, &mesh);
    }
}

fn same_tree_everywhere<const N: usize>(what: &str, mesh: &Mesh) {
    let pools = [1, 2, 8].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap());
    let thorough = std::env::var_os("PHR_THOROUGH").is_some();
    let same = |name: &str, build: &(dyn Fn(Isa) -> WideBvh<N> + Sync)| {
        let mut expected = None;
        for (i, isa) in Isa::available().enumerate() {
            // How tasks are divided is the same with any instructions: without time for all, each has its own number.
            for pool in if thorough { &pools[..] } else { &pools[i..=i] } {
                let tree = pool.install(|| build(isa));
                let threads = pool.current_num_threads();
                let expected = expected.get_or_insert_with(|| tree.clone());
                assert!(tree == *expected, "{what}, {name}, width {N}: {isa:?}, {threads} threads");
            }
        }
    };
    for (name, config) in configs() {
        same(name, &|isa| Phr::with_isa("", config, isa).unwrap().build(mesh).tree);
    }
    same("lbvh", &|isa| Lbvh::with_isa(isa).build(mesh).tree);
    let best = OptimisedPhrConfig { phr: PhrConfig::HQ, optimise: OptimiseConfig::DEFAULT };
    same("optimised", &|isa| OptimisedPhr::with_isa("", best, isa).unwrap().build(mesh).tree);
    for config in CLUSTERED {
        same("clustered", &|isa| ClusteredPhr::with_isa("", config, isa).unwrap().build(mesh).tree);
    }
    for config in PLOC {
        same("ploc", &|isa| Ploc::with_isa(config, isa).unwrap().build(mesh).tree);
    }
    for config in HUNT {
        same("hunt", &|isa| Hunt::with_isa("", config, isa).unwrap().build(mesh).tree);
    }
}
