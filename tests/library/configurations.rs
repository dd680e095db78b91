//! Random configurations on random meshes of any scale: refused in one line, or a whole tree in which rays find every
//! triangle.

use glam::Vec3;
use phr::builders::{
    Aac, AacConfig, AuxiliaryConfig, AuxiliaryTree, BinnedSahConfig, Build, Builder, ClusteredPhr,
    ClusteredPhrConfig, Clusters, CollapseCosts, ConfigError, Extensions, Hunt, HuntConfig, LocalThreshold,
    MergedPhr, NAMES, OptimiseConfig, OptimisedPhr, OptimisedPhrConfig, Phr, PhrConfig, Ploc, PlocConfig,
    PresplitConfig, by_name,
};
use phr::geometry::{Hit, Mesh, Ray, Tracer};
use phr::random::SplitMix64;
use phr::trace::{BruteForce, BvhTracer};

/// Triangles of many shapes: slivers, walls, copies and large ones among small.
fn mesh(random: &mut SplitMix64, n: usize, scale: f32) -> Mesh {
    let mut vertices = Vec::new();
    for i in 0..n {
        let at = random.point(-1.0, 1.0);
        let size = [0.02, 0.3, 1.0, 0.0][random.below(4)];
        let mut corners = [0; 3].map(|_| at + random.point(-1.0, 1.0) * size);
        match random.below(5) {
            // A needle, a wall, a copy of the one before.
            0 => corners[2] = corners[0] + Vec3::X * 1e-4,
            1 => corners.iter_mut().for_each(|corner| corner.y = (at.y * 4.0).floor() / 4.0),
            2 if i > 0 => corners = [3, 2, 1].map(|back| vertices[3 * i - back]),
            _ => {}
        }
        vertices.extend(corners);
    }
    let vertices =
        vertices.iter().map(|v: &Vec3| (v.clamp(Vec3::NEG_ONE, Vec3::ONE) * scale).to_array()).collect();
    Mesh::new(vertices, (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap().0
}

/// A value of a list.
fn one<T: Copy>(random: &mut SplitMix64, of: &[T]) -> T {
    of[random.below(of.len())]
}

/// The same, or none.
fn maybe_float(random: &mut SplitMix64, of: &[f32]) -> Option<f32> {
    let value = float(random, of);
    maybe(random, &[value])
}

/// A value of a list, or none: extensions are off more often than not.
fn maybe<T: Copy>(random: &mut SplitMix64, of: &[T]) -> Option<T> {
    (random.below(3) == 0).then(|| one(random, of))
}

const WILD: [f32; 6] = [0.0, -1.0, 1e30, f32::NAN, f32::INFINITY, 1e-30];

/// A value of a list, or rarely a wild one.
fn float(random: &mut SplitMix64, of: &[f32]) -> f32 {
    if random.below(40) == 0 { one(random, &WILD) } else { one(random, of) }
}

fn costs(random: &mut SplitMix64) -> CollapseCosts {
    CollapseCosts {
        node: float(random, &[1.0, 0.0, 3.0]),
        leaf: float(random, &[0.5, 0.0]),
        block: float(random, &[0.35, 1.0, 0.0]),
        max_leaf: one(random, &[4, 8, 16, 28, 28, 28, 29, 0]),
    }
}

fn presplit(random: &mut SplitMix64) -> PresplitConfig {
    PresplitConfig {
        filled: float(random, &[0.15, 0.5]),
        min_area: float(random, &[1e-4, 1e-6]),
        max_extra: float(random, &[0.25, 3.0]),
    }
}

fn phr(random: &mut SplitMix64) -> PhrConfig {
    let presplit = presplit(random);
    let clusters = Clusters { most: one(random, &[1, 32, 300]), area: float(random, &[1e-3, 1.0, 0.0]) };
    let local = LocalThreshold { references: one(random, &[0, 30, 1000]), area: float(random, &[1e-2, 1.0]) };
    let collapse = costs(random);
    PhrConfig {
        alpha: float(random, &[0.5, 0.55, 0.0, 3.0]),
        delta: float(random, &[6.0, 9.0, 0.0, 20.0]),
        max_cut: one(random, &[2048, 1, 2, 50]),
        spatial_threshold: float(random, &[1e-3, 1e-6, 0.0, 1e-2]),
        max_leaf: one(random, &[8, 4, 28, 12, 28, 28, 29, 1000, 3]),
        max_references: float(random, &[2.0, 1.0, 4.0]),
        extensions: Extensions {
            auxiliary: AuxiliaryConfig {
                bucket_sort: random.below(4) == 0,
                presplit: maybe(random, &[presplit]),
                auxiliary_leaf: maybe(random, &[1, 2, 3, 4, 4, 4, 5, 0]),
                clusters: maybe(random, &[clusters]),
                calibration: maybe_float(random, &[1e3, 0.3, 0.0]),
            },
            auxiliary_tree: one(
                random,
                &[
                    AuxiliaryTree::Lbvh,
                    AuxiliaryTree::Lbvh,
                    AuxiliaryTree::Lbvh,
                    AuxiliaryTree::Ploc(PlocConfig { radius: 5 }),
                    AuxiliaryTree::Aac(AacConfig::FAST),
                    AuxiliaryTree::BinnedSah(BinnedSahConfig { bins: 16 }),
                ],
            ),
            cut_share: maybe_float(random, &[0.1, 1.0, 0.0]),
            local_threshold: maybe(random, &[local]),
            clip_triangles: random.below(2) == 0,
            triangle_counts: random.below(4) == 0,
            subtree_sweep: maybe(random, &[32, 256, 5, 32, 32, 257]),
            collapse: maybe(random, &[collapse]),
        },
    }
}

fn builder<const N: usize>(random: &mut SplitMix64) -> Result<Box<dyn Builder<N>>, ConfigError> {
    Ok(match random.below(10) {
        0 => Box::new(Hunt::new(
            "hunt",
            HuntConfig {
                cut_length: one(random, &[2, 7, 50, 500, 1, 0]),
                max_leaf: one(random, &[8, 28, 40]),
            },
        )?),
        1 => Box::new(Aac::new(AacConfig {
            delta: one(random, &[4, 1, 20, 64, 0, 65]),
            epsilon: one(random, &[0.2, 0.1, 0.5, 0.0, -1.0, f64::NAN]),
        })?),
        2 => Box::new(OptimisedPhr::new(
            "best",
            OptimisedPhrConfig {
                phr: phr(random),
                optimise: OptimiseConfig {
                    rounds: one(random, &[0, 1, 4]),
                    share: float(random, &[0.1, 1.0, 0.0]),
                    costs: costs(random),
                },
            },
        )?),
        3 => Box::new(Ploc::new(PlocConfig { radius: one(random, &[1, 2, 25, 128, 0, 129]) })?),
        4 => by_name(one(random, NAMES)).expect("a name of the list"),
        5 => Box::new(ClusteredPhr::new(
            "clustered",
            ClusteredPhrConfig {
                alpha: float(random, &[0.45, 0.0, 3.0]),
                delta: float(random, &[5.0, 0.0, 20.0]),
                max_cut: one(random, &[2048, 1, 50, 0]),
                spatial_threshold: float(random, &[3e-2, 1e-6, 0.0, 1.0]),
                clusters: Clusters {
                    most: one(random, &[512, 1, 32, 4096, 0, 4097]),
                    area: float(random, &[1e-2, 1.0, 0.0]),
                },
                presplit: {
                    let presplit = presplit(random);
                    maybe(random, &[presplit])
                },
            },
        )?),
        _ => Box::new(Phr::new("phr", phr(random))?),
    })
}

/// Aims a ray at the middle of each triangle, and compares the hits with those of brute force.
fn check_hits<const N: usize>(mesh: &Mesh, build: &Build<N>, what: &str) {
    let extent = mesh.bounds().extent().length();
    let mut rays = Vec::new();
    for prim in 0..mesh.len() as u32 {
        let [a, b, c] = mesh.corners(prim);
        let normal = ((b - a) / extent).cross((c - a) / extent);
        // Slivers are hit or missed by rounding.
        if normal.length() > 1e-4 {
            let dir = -normal.normalize();
            let org = a * 0.3 + b * 0.36 + c * 0.34 - dir * extent;
            rays.push(Ray { org: org.into(), tnear: 0.0, dir: dir.into(), tfar: f32::INFINITY });
        }
    }
    let (mut found, mut expected) = (vec![Hit::MISS; rays.len()], vec![Hit::MISS; rays.len()]);
    BvhTracer::new(&build.tree).closest(&rays, &mut found);
    BruteForce(mesh).closest(&rays, &mut expected);
    for (found, expected) in found.iter().zip(&expected) {
        assert!(expected.is_hit(), "{what}: a ray aimed at a triangle hits one");
        let error = (found.t - expected.t).abs();
        assert!(found.is_hit() && error <= 1e-4 * expected.t, "{what}: {found:?} for {expected:?}");
    }
}

#[test]
fn configurations_are_refused_or_their_trees_are_whole() {
    let built =
        (0..3000).filter(|seed| if seed % 2 == 0 { check::<4>(*seed) } else { check::<8>(*seed) }).count();
    assert!((1500..2700).contains(&built), "{built} built, the others refused");
}

/// Checks the configuration of a seed; returns whether it was not refused.
fn check<const N: usize>(seed: u64) -> bool {
    const SCALES: [f32; 10] = [1.0, 1e-38, 1e-20, 1e-11, 1e-6, 1e6, 1e11, 1e18, 1.8e18, 1.0];
    let mut random = SplitMix64::new(seed);
    let scale = one(&mut random, &SCALES);
    let n = one(&mut random, &[0, 1, 2, 5, 30, 150, 600, 1000]);
    let mesh = mesh(&mut random, n, scale);
    let mut builder = match builder::<N>(&mut random) {
        Ok(builder) => builder,
        Err(error) => {
            assert_eq!(error.to_string().lines().count(), 1, "{error}");
            return false;
        }
    };
    #[cfg(feature = "serde")]
    let config = builder.config();
    #[cfg(not(feature = "serde"))]
    let config = "(its parameters are told with the feature serde)";
    let what = format!("seed {seed}, {} {config}, width {N}, scale {scale}", builder.name());
    let build = builder.build(&mesh);
    assert_eq!(build.tree.validate(&mesh), Ok(()), "{what}");
    // Beyond, the product of three lengths that the kernels compare is infinite or zero.
    if (1e-11..=1e11).contains(&scale) {
        check_hits(&mesh, &build, &what);
    }
    true
}

#[test]
fn huge_scenes_have_whole_trees_by_every_builder() {
    for (n, scale) in [(1000, 1e18), (1000, 1.8e18), (3000, 1.8e18), (1000, 1e-38)] {
        let mesh = mesh(&mut SplitMix64::new(n as u64), n, scale);
        for name in NAMES {
            whole::<4>(name, &mesh);
            whole::<8>(name, &mesh);
        }
    }
}

fn whole<const N: usize>(name: &str, mesh: &Mesh) {
    let build = by_name::<N>(name).unwrap().build(mesh);
    let largest = mesh.bounds().extent().max_element();
    assert_eq!(build.tree.validate(mesh), Ok(()), "{name}, width {N}, {} triangles of {largest}", mesh.len());
}

#[test]
fn refusals_name_the_parameter_its_value_and_its_range() {
    let refused = |config| Phr::<4>::new("", config).err().unwrap().to_string();
    let error = refused(PhrConfig { max_leaf: 1000, ..PhrConfig::FAST });
    assert_eq!(error, "max_leaf = 1000 is out of range; give 4 to 28");
    let error = refused(PhrConfig { alpha: f32::NAN, ..PhrConfig::FAST });
    assert_eq!(error, "alpha = NaN is out of range; give 0.0 to 16.0");
    let error = Aac::<4>::new(AacConfig { delta: 0, epsilon: 0.2 }).err().unwrap().to_string();
    assert_eq!(error, "delta = 0 is out of range; give 1 to 64");
    let error = Ploc::<8>::new(PlocConfig { radius: 0 }).err().unwrap().to_string();
    assert_eq!(error, "radius = 0 is out of range; give 1 to 128");
    let auxiliary_tree = AuxiliaryTree::BinnedSah(BinnedSahConfig { bins: 65 });
    let extensions = Extensions { auxiliary_tree, ..Extensions::NONE };
    let error = refused(PhrConfig { extensions, ..PhrConfig::HQ });
    assert_eq!(error, "auxiliary_tree.binned-sah.bins = 65 is out of range; give 2 to 64");
    let extensions = Extensions { collapse: Some(CollapseCosts::EMBREE), ..Extensions::NONE };
    let phr = PhrConfig { extensions, ..PhrConfig::HQ };
    let config = OptimisedPhrConfig { phr, optimise: OptimiseConfig::DEFAULT };
    let error = OptimisedPhr::<4>::new("", config).err().unwrap().to_string();
    assert_eq!(error, "phr.collapse = on is out of range; give none");
    let costs = CollapseCosts { max_leaf: 99, ..CollapseCosts::EMBREE };
    let optimise = OptimiseConfig { costs, ..OptimiseConfig::DEFAULT };
    let config = OptimisedPhrConfig { phr: PhrConfig::HQ, optimise };
    let error = OptimisedPhr::<4>::new("", config).err().unwrap().to_string();
    assert_eq!(error, "optimise.costs.max_leaf = 99 is out of range; give 4 to 28");
    let mut merged = MergedPhr::<4>::new(PhrConfig::SPEED).unwrap();
    let mesh = mesh(&mut SplitMix64::new(1), 30, 1.0);
    for (tree, error) in [
        (auxiliary_tree, "binned-sah.bins = 65 is out of range; give 2 to 64"),
        (
            AuxiliaryTree::BinnedSah(BinnedSahConfig { bins: 0 }),
            "binned-sah.bins = 0 is out of range; give 2 to 64",
        ),
        (AuxiliaryTree::Ploc(PlocConfig { radius: 0 }), "ploc.radius = 0 is out of range; give 1 to 128"),
        (
            AuxiliaryTree::Aac(AacConfig { delta: 0, epsilon: 0.2 }),
            "aac.delta = 0 is out of range; give 1 to 64",
        ),
    ] {
        assert_eq!(merged.keep(&mesh, 20, tree).unwrap_err().to_string(), error);
    }
}
