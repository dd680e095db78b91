//! What neighbours of the constants that were chosen by looking at scenes give: a line of CSV for each constant,
//! value and scene, and a last one with their number. `cargo bench --bench constants -- [--rounds=N]
//! [--only=PRESET] SCENE...`, generators' names or files; costs and counts are exact, build times are the least of
//! N rounds (3) in which the preset and its variant take turns, none with `--rounds=0`. Trees are 4-wide and 8-wide.

#![allow(missing_docs)] // a program

use phr::builders::{
    Builder, ClusteredPhr, ClusteredPhrConfig, Clusters, CollapseCosts, Extensions, LocalThreshold,
    OptimisedPhr, OptimisedPhrConfig, Phr, PhrConfig, PresplitConfig,
};
use phr::bvh::WideBvh;
use phr::geometry::{Mesh, Ray};
use phr::scene::{self, Scene};
use phr::trace::{BvhTracer, PathSettings, RayKind, record};
use std::path::Path;
use std::time::Instant;

/// The configuration of a preset.
trait Preset: Copy {
    fn builder<const N: usize>(&self, name: &'static str) -> Box<dyn Builder<N>>;
}

impl Preset for ClusteredPhrConfig {
    fn builder<const N: usize>(&self, name: &'static str) -> Box<dyn Builder<N>> {
        Box::new(ClusteredPhr::<N>::new(name, *self).expect("in range"))
    }
}

/// One that does not optimise leaves that part of the configuration alone.
#[derive(Clone, Copy)]
struct Cuts {
    config: OptimisedPhrConfig,
    is_optimised: bool,
}

impl Cuts {
    fn of(phr: PhrConfig) -> Self {
        Self { config: OptimisedPhrConfig { phr, ..OptimisedPhrConfig::DEFAULT }, is_optimised: false }
    }
}

impl Preset for Cuts {
    fn builder<const N: usize>(&self, name: &'static str) -> Box<dyn Builder<N>> {
        if self.is_optimised {
            Box::new(OptimisedPhr::<N>::new(name, self.config).expect("in range"))
        } else {
            Box::new(Phr::<N>::new(name, self.config.phr).expect("in range"))
        }
    }
}

/// A constant of a preset: its name, neighbouring values, and how it is set.
type Constant<P> = (&'static str, &'static [f64], fn(&mut P, f32));

const DRAFT: [Constant<ClusteredPhrConfig>; 5] = [
    ("alpha", &[0.4, 0.5], |c, v| c.alpha = v),
    ("delta", &[4.0, 6.0], |c, v| c.delta = v),
    ("max_cut", &[256.0, 1024.0], |c, v| c.max_cut = v as usize),
    ("clusters.most", &[1024.0, 2048.0], |c, v| c.clusters.most = v as u32),
    ("clusters.area", &[1.5e-2, 6e-2], |c, v| c.clusters.area = v),
];

fn needles(preset: &mut ClusteredPhrConfig) -> &mut PresplitConfig {
    preset.presplit.as_mut().expect("a preset that presplits")
}

const TURBO: [Constant<ClusteredPhrConfig>; 9] = [
    ("alpha", &[0.4, 0.5], |c, v| c.alpha = v),
    ("delta", &[4.0, 6.0], |c, v| c.delta = v),
    ("max_cut", &[1024.0, 4096.0], |c, v| c.max_cut = v as usize),
    ("spatial_threshold", &[1.5e-2, 6e-2], |c, v| c.spatial_threshold = v),
    ("presplit.filled", &[0.075, 0.3], |c, v| needles(c).filled = v),
    ("clusters.most", &[256.0, 1024.0], |c, v| c.clusters.most = v as u32),
    ("clusters.area", &[1.5e-3, 6e-3], |c, v| c.clusters.area = v),
    ("presplit.min_area", &[1.0 / 16384.0, 1.0 / 4096.0], |c, v| needles(c).min_area = v),
    ("presplit.max_extra", &[0.03125, 0.125], |c, v| needles(c).max_extra = v),
];

fn extensions(preset: &mut Cuts) -> &mut Extensions {
    &mut preset.config.phr.extensions
}

fn clusters(preset: &mut Cuts) -> &mut Clusters {
    extensions(preset).auxiliary.clusters.as_mut().expect("a preset with clusters")
}

fn local(preset: &mut Cuts) -> &mut LocalThreshold {
    extensions(preset).local_threshold.as_mut().expect("a preset with a local threshold")
}

fn presplit(preset: &mut Cuts) -> &mut PresplitConfig {
    extensions(preset).auxiliary.presplit.as_mut().expect("a preset that presplits")
}

/// The costs of the treelets' collapse, or of the optimised tree's.
fn costs(preset: &mut Cuts) -> &mut CollapseCosts {
    match &mut preset.config.phr.extensions.collapse {
        Some(costs) => costs,
        None => &mut preset.config.optimise.costs,
    }
}

/// Of presets that both presplit and collapse.
const QUALITY_AND_BEST: [Constant<Cuts>; 6] = [
    ("presplit.filled", &[0.075, 0.3], |c, v| presplit(c).filled = v),
    ("presplit.min_area", &[1.0 / 65536.0, 1.0 / 16384.0], |c, v| presplit(c).min_area = v),
    ("presplit.max_extra", &[0.125, 0.5], |c, v| presplit(c).max_extra = v),
    ("collapse.leaf", &[0.25, 1.0], |c, v| costs(c).leaf = v),
    ("collapse.block", &[0.175, 0.7], |c, v| costs(c).block = v),
    ("collapse.max_leaf", &[8.0, 28.0], |c, v| costs(c).max_leaf = v as u32),
];

/// The length of the initial cut, whatever share of the triangles it is.
fn max_cut(preset: &mut Cuts, most: f32) {
    preset.config.phr.max_cut = most as usize;
    extensions(preset).cut_share = Some(1.0 / 32.0);
}

const FAST: [Constant<Cuts>; 2] = [
    ("max_leaf", &[4.0, 16.0], |c, v| c.config.phr.max_leaf = v as u32),
    ("max_references", &[1.5, 4.0], |c, v| c.config.phr.max_references = v),
];

const SPEED: [Constant<Cuts>; 12] = [
    ("alpha", &[0.4, 0.5], |c, v| c.config.phr.alpha = v),
    ("delta", &[4.0, 6.0], |c, v| c.config.phr.delta = v),
    ("spatial_threshold", &[1.5e-2, 6e-2], |c, v| c.config.phr.spatial_threshold = v),
    ("max_cut", &[1024.0, 4096.0], max_cut),
    ("cut_share", &[1.0 / 512.0, 1.0 / 128.0], |c, v| extensions(c).cut_share = Some(v)),
    ("auxiliary_leaf", &[1.0, 2.0], |c, v| extensions(c).auxiliary.auxiliary_leaf = Some(v as u32)),
    ("calibration", &[500.0, 2000.0], |c, v| extensions(c).auxiliary.calibration = Some(v)),
    ("own_threshold.references", &[16384.0, 65536.0], |c, v| local(c).references = v as u32),
    ("own_threshold.area", &[1.0 / 512.0, 1.0 / 128.0], |c, v| local(c).area = v),
    ("presplit.filled", &[0.075, 0.3], |c, v| presplit(c).filled = v),
    ("presplit.min_area", &[1.0 / 65536.0, 1.0 / 16384.0], |c, v| presplit(c).min_area = v),
    ("presplit.max_extra", &[0.125, 0.5], |c, v| presplit(c).max_extra = v),
];

const QUALITY: [Constant<Cuts>; 9] = [
    ("spatial_threshold", &[5e-4, 2e-3], |c, v| c.config.phr.spatial_threshold = v),
    ("max_cut", &[1024.0, 4096.0], max_cut),
    ("cut_share", &[1.0 / 512.0, 1.0 / 128.0], |c, v| extensions(c).cut_share = Some(v)),
    ("clusters.most", &[16.0, 64.0], |c, v| clusters(c).most = v as u32),
    ("clusters.area", &[5e-5, 2e-4], |c, v| clusters(c).area = v),
    ("calibration", &[500.0, 2000.0], |c, v| extensions(c).auxiliary.calibration = Some(v)),
    ("own_threshold.references", &[16384.0, 65536.0], |c, v| local(c).references = v as u32),
    ("own_threshold.area", &[1.0 / 512.0, 1.0 / 128.0], |c, v| local(c).area = v),
    ("subtree_sweep", &[16.0, 64.0], |c, v| extensions(c).subtree_sweep = Some(v as u32)),
];

const BEST: [Constant<Cuts>; 9] = [
    ("alpha", &[0.5, 0.6], |c, v| c.config.phr.alpha = v),
    ("delta", &[7.0, 9.0], |c, v| c.config.phr.delta = v),
    ("max_cut", &[32768.0, 131072.0], |c, v| c.config.phr.max_cut = v as usize),
    ("cut_share", &[1.0 / 64.0, 1.0 / 16.0], |c, v| extensions(c).cut_share = Some(v)),
    ("spatial_threshold", &[1.5e-4, 6e-4], |c, v| c.config.phr.spatial_threshold = v),
    ("subtree_sweep", &[32.0, 128.0], |c, v| extensions(c).subtree_sweep = Some(v as u32)),
    ("calibration", &[500.0, 2000.0], |c, v| extensions(c).auxiliary.calibration = Some(v)),
    ("rounds", &[2.0, 8.0], |c, v| c.config.optimise.rounds = v as u32),
    ("share", &[0.05, 0.2], |c, v| c.config.optimise.share = v),
];

/// What is exact of a tree: SAH cost, references per triangle, node visits and block tests per ray.
fn measure<const N: usize>(tree: &WideBvh<N>, mesh: &Mesh, rays: &[(RayKind, Vec<Ray>)]) -> [f64; 4] {
    let tracer = BvhTracer::new(tree);
    let of = |(kind, rays): &(RayKind, Vec<Ray>)| {
        if kind.is_any_hit() { tracer.count_any(rays) } else { tracer.count_closest(rays) }
    };
    let counts = rays.iter().map(of).reduce(|a, b| a + b).expect("some rays");
    let references = tree.blocks.iter().map(|block| block.ids().count()).sum::<usize>();
    let per_ray = |count: u64| count as f64 / counts.rays as f64;
    [
        phr::bvh::sah_cost(tree),
        references as f64 / mesh.len() as f64,
        per_ray(counts.node_visits),
        per_ray(counts.block_tests),
    ]
}

/// Milliseconds of a build, and what is exact of its tree where that is asked for.
fn build<const N: usize>(
    builder: &mut dyn Builder<N>,
    mesh: &Mesh,
    of_tree: Option<&[(RayKind, Vec<Ray>)]>,
) -> (f64, Option<[f64; 4]>) {
    let clock = Instant::now();
    let tree = builder.build(mesh).tree;
    let ms = 1e3 * clock.elapsed().as_secs_f64();
    let exact = of_tree.map(|rays| measure(&tree, mesh, rays));
    builder.recycle(tree);
    (ms, exact)
}

/// Prints a line for each value of the constants. Returns how many.
fn compare<const N: usize, P: Preset>(
    (scene, rays): (&Scene, &[(RayKind, Vec<Ray>)]),
    (name, preset): (&'static str, P),
    constants: &[Constant<P>],
    rounds: usize,
) -> usize {
    let mut base = preset.builder::<N>(name);
    let (_, exact) = build(&mut *base, &scene.mesh, Some(rays));
    let of_base = exact.expect("asked for");
    for (constant, values, set) in constants {
        for &value in *values {
            let mut variant = preset;
            set(&mut variant, value as f32);
            let mut variant = variant.builder::<N>(name);
            let (_, exact) = build(&mut *variant, &scene.mesh, Some(rays));
            let (mut least, mut least_of_base) = (f64::INFINITY, f64::INFINITY);
            for _ in 0..rounds {
                least_of_base = least_of_base.min(build(&mut *base, &scene.mesh, None).0);
                least = least.min(build(&mut *variant, &scene.mesh, None).0);
            }
            let exact = exact.expect("asked for");
            let ratios =
                std::array::from_fn::<_, 4, _>(|i| format!("{:.4}", exact[i] / of_base[i])).join(",");
            let build = if rounds == 0 { String::new() } else { format!("{:.3}", least / least_of_base) };
            println!("{},{name},{N},{constant},{value},{ratios},{build}", scene.name);
        }
    }
    constants.iter().map(|(_, values, _)| values.len()).sum()
}

fn main() {
    let (options, names): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.starts_with("--"));
    let rounds = options.iter().find_map(|option| option.strip_prefix("--rounds="));
    let rounds = rounds.map_or(3, |rounds| rounds.parse().expect("--rounds=N"));
    let only = options.iter().find_map(|option| option.strip_prefix("--only="));
    let best = Cuts { config: OptimisedPhrConfig::DEFAULT, is_optimised: true };
    let presets = [
        ("phr-fast", Cuts::of(PhrConfig::FAST), FAST.to_vec()),
        ("phr-speed", Cuts::of(PhrConfig::SPEED), SPEED.to_vec()),
        ("phr-quality", Cuts::of(PhrConfig::QUALITY), [&QUALITY[..], &QUALITY_AND_BEST].concat()),
        ("phr-best", best, [&BEST[..], &QUALITY_AND_BEST].concat()),
    ];
    let is_asked = |preset: &str| only.is_none_or(|only| only == preset);
    println!("scene,preset,width,constant,value,sah,refs_per_tri,node_visits,block_tests,build");
    let mut lines = 0;
    for name in names {
        let scene = match scene::generator(&name) {
            Some(generator) => generator.generate(),
            None => scene::load(Path::new(&name)).unwrap_or_else(|why| panic!("{why}")),
        };
        let tree = Phr::<4>::new("", PhrConfig::SPEED).expect("in range").build(&scene.mesh).tree;
        let settings = PathSettings { width: 96, height: 96, ..PathSettings::default() };
        let views = scene.views.iter().take(3);
        let rays: Vec<(RayKind, Vec<Ray>)> = views
            .flat_map(|view| {
                let batches = record(&BvhTracer::new(&tree), &scene.mesh, view, &settings).batches;
                RayKind::ALL.map(|kind| (kind, batches.get(kind).to_vec()))
            })
            .collect();
        let of_scene = (&scene, &rays[..]);
        let clustered = [
            ("phr-draft", ClusteredPhrConfig::DRAFT, &DRAFT[..]),
            ("phr-turbo", ClusteredPhrConfig::TURBO, &TURBO),
        ];
        for (name, preset, constants) in clustered {
            if is_asked(name) {
                lines += compare::<4, _>(of_scene, (name, preset), constants, rounds);
                lines += compare::<8, _>(of_scene, (name, preset), constants, rounds);
            }
        }
        for (name, preset, constants) in &presets {
            if is_asked(name) {
                lines += compare::<4, _>(of_scene, (*name, *preset), constants, rounds);
                lines += compare::<8, _>(of_scene, (*name, *preset), constants, rounds);
            }
        }
    }
    println!("# rows: {lines}");
}
