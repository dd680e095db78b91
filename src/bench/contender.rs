//! Who is measured: a cell is a builder at a width with the kernels that trace its tree. A contender builds
//! in its own way, in its own clock, and shows the finished tree to the observer who traces it.

use super::load::{Accounts, Load};
use crate::build::{self, Builder};
use crate::bvh::{Statistics, WideBvh};
use crate::geometry::{Mesh, Ray, Tracer};
use crate::trace::{BvhTracer, Isa, RayKind, TraversalCounts};
use rayon::ThreadPool;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// What traces a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kernel {
    /// Embree's kernel on a tree of Embree's, where it built it.
    EmbreeNative,
    /// Embree's kernel on any tree, all laid out alike.
    EmbreeGrafted,
    /// Our kernel.
    Phr,
}

impl Kernel {
    /// All kernels, in the table's order.
    pub const ALL: [Self; 3] = [Self::EmbreeNative, Self::EmbreeGrafted, Self::Phr];

    /// The name in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::EmbreeNative => "embree-native",
            Self::EmbreeGrafted => "embree-grafted",
            Self::Phr => "phr",
        }
    }

    /// The kernel called `name`.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kernel| kernel.name() == name)
    }
}

/// A builder at a width.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Cell {
    /// The builder's name.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// Kernels that trace its tree; none if only builds are timed.
    pub kernels: Vec<Kernel>,
}

impl Cell {
    /// What a filter is matched against.
    pub fn line(&self, scene: &str, kernel: &str) -> String {
        format!("{scene} {} {} {kernel}", self.builder, self.width)
    }

    /// One line per kernel.
    pub fn lines(&self, scene: &str) -> Vec<String> {
        if self.kernels.is_empty() {
            return vec![self.line(scene, super::records::NO_KERNEL)];
        }
        self.kernels.iter().map(|kernel| self.line(scene, kernel.name())).collect()
    }
}

/// The order of the table: the paper's, with what it lacks at the place of its kind.
pub const ORDER: [&str; 9] = [
    "lbvh",
    "embree-morton",
    "hunt-50",
    "aac",
    "embree-sah",
    "hunt-500",
    "embree-fast-spatial",
    "phr-fast",
    "phr-hq",
];

/// A builder's place in the table; those of no fixed place come last.
pub fn place(builder: &str) -> usize {
    ORDER.iter().position(|name| *name == builder).unwrap_or(ORDER.len())
}

/// All cells of this program, in the table's order.
pub fn cells(build_only: bool) -> Vec<Cell> {
    let ours = build::NAMES.iter().chain(build::ABLATION).map(|name| Cell {
        builder: (*name).into(),
        width: 4,
        kernels: super::embree_side::kernels_of_ours(),
    });
    let mut cells: Vec<Cell> = ours.chain(super::embree_side::cells()).collect();
    cells.sort_by_key(|cell| (place(&cell.builder), cell.width));
    if build_only {
        cells.iter_mut().for_each(|cell| cell.kernels.clear());
    }
    cells
}

/// Durations of one visit's builds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Builds {
    /// The first build of a fresh builder object or device, ms.
    pub cold_ms: f64,
    /// The builds after it, ms.
    pub warm_ms: Vec<f64>,
    /// Parts of the last build, ms; empty for Embree, which does not tell.
    pub phases: Vec<(String, f64)>,
    /// Bytes held at the peak of the last build.
    pub peak_bytes: Option<u64>,
    /// What the processors did during the warm builds.
    pub load: Load,
}

/// What is known of a tree beside its speed; what could not be had is absent.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Facts {
    /// Who built it, with version.
    pub engine: String,
    /// The builder's parameters.
    pub config: String,
    /// SAH cost.
    pub sah: Option<f64>,
    /// End-point overlap.
    pub epo: Option<f64>,
    /// Inner nodes.
    pub nodes: Option<u64>,
    /// Leaves.
    pub leaves: Option<u64>,
    /// Levels of inner nodes.
    pub depth: Option<u64>,
    /// Used lanes of leaf blocks.
    pub leaf_fill: Option<f64>,
    /// References per triangle.
    pub refs_per_tri: Option<f64>,
    /// Bytes of the tree.
    pub bytes: Option<u64>,
}

impl Facts {
    /// Those of a tree in our own form.
    pub fn of(statistics: &Statistics, engine: String, config: String) -> Self {
        Self {
            engine,
            config,
            sah: Some(statistics.sah),
            epo: Some(statistics.epo),
            nodes: Some(statistics.nodes as u64),
            leaves: Some(statistics.leaves as u64),
            depth: Some(statistics.depth as u64),
            leaf_fill: Some(statistics.leaf_fill),
            refs_per_tri: Some(statistics.references_per_triangle),
            bytes: Some(statistics.bytes as u64),
        }
    }
}

/// A tree under one kernel.
pub struct View<'a> {
    /// The kernel.
    pub kernel: Kernel,
    /// Its instruction set.
    pub isa: String,
    /// The tree under it, or why that cannot be had.
    pub tracer: Result<&'a dyn Tracer, String>,
    /// Counts what the kernel does, untimed.
    pub counter: Option<&'a dyn Counter>,
}

/// Counts node visits and block tests.
pub trait Counter: Sync {
    /// For a batch of `kind`.
    fn count(&self, kind: RayKind, rays: &[Ray]) -> TraversalCounts;
}

impl<const N: usize> Counter for BvhTracer<'_, N> {
    fn count(&self, kind: RayKind, rays: &[Ray]) -> TraversalCounts {
        let count =
            |rays: &[Ray]| if kind.is_any_hit() { self.count_any(rays) } else { self.count_closest(rays) };
        rays.par_chunks(1 << 12).map(count).reduce(TraversalCounts::default, |a, b| a + b)
    }
}

/// What a visit asks of a contender.
pub struct Visit<'a> {
    /// The geometry.
    pub mesh: &'a Mesh,
    /// The threads that ours build with; Embree makes as many of its own.
    pub pool: &'a ThreadPool,
    /// Kernels wanted.
    pub kernels: &'a [Kernel],
    /// Whether facts are wanted (they take time, untimed).
    pub facts: bool,
}

/// What a contender shows when its tree stands.
pub struct Shown<'a> {
    /// Durations.
    pub builds: Builds,
    /// Facts, if wanted.
    pub facts: Option<Facts>,
    /// The tree under each kernel wanted.
    pub views: Vec<View<'a>>,
}

/// Builds `cell`'s tree, once cold and then warm, and shows it; it is gone when this returns.
///
/// # Errors
/// A builder that failed or was not the one asked for, in one line.
pub fn visit(cell: &Cell, visit: &Visit<'_>, observer: &mut dyn FnMut(Shown<'_>)) -> Result<(), String> {
    match build::by_name(&cell.builder) {
        Some(builder) => {
            ours(builder, visit, observer);
            Ok(())
        }
        None => super::embree_side::visit(cell, visit, observer),
    }
}

/// Our side: in the clock is what leads from the mesh in memory to a traversable tree with its leaf data.
fn ours(mut builder: Box<dyn Builder>, visit: &Visit<'_>, observer: &mut dyn FnMut(Shown<'_>)) {
    let mut build = || {
        visit.pool.install(|| {
            let start = Instant::now();
            let built = builder.build(visit.mesh);
            (start.elapsed(), built)
        })
    };
    let (cold, first) = build();
    drop(first);
    let accounts = Accounts::read();
    let mut warm = Vec::new();
    let built = loop {
        let (duration, built) = build();
        warm.push(duration);
        if is_enough(&warm) {
            break built;
        }
    };
    let builds = Builds {
        cold_ms: ms(cold),
        warm_ms: warm.into_iter().map(ms).collect(),
        phases: built.phases.iter().map(|phase| (phase.name.into(), ms(phase.duration))).collect(),
        peak_bytes: Some(built.counts.peak_bytes).filter(|&bytes| bytes > 0),
        load: accounts.since(),
    };
    let facts = visit.facts.then(|| {
        let engine = format!("phr {}", env!("CARGO_PKG_VERSION"));
        let statistics = visit.pool.install(|| Statistics::of(&built.tree, visit.mesh));
        Facts::of(&statistics, engine, builder.config().to_string())
    });
    present(visit, Ok(&built.tree), None, builds, facts, observer);
}

/// Shows a tree under each kernel wanted: `tree` in our form, or why it cannot be had so; `native` is
/// Embree's own scene, if Embree built it.
pub(super) fn present<const N: usize>(
    visit: &Visit<'_>,
    tree: Result<&WideBvh<N>, String>,
    native: Option<&dyn Tracer>,
    builds: Builds,
    facts: Option<Facts>,
    observer: &mut dyn FnMut(Shown<'_>),
) {
    let tracer = tree.clone().map(BvhTracer::new);
    let mut shown = Some((builds, facts));
    let grafted = visit.kernels.contains(&Kernel::EmbreeGrafted);
    let to_graft = if grafted { tree } else { Err("it was not asked for".into()) };
    super::embree_side::with_graft(visit, to_graft, &mut |graft| {
        let view = |&kernel: &Kernel| match kernel {
            Kernel::Phr => View {
                kernel,
                isa: Isa::best().name().into(),
                tracer: tracer.as_ref().map(|tracer| tracer as &dyn Tracer).map_err(Clone::clone),
                counter: tracer.as_ref().ok().map(|tracer| tracer as &dyn Counter),
            },
            Kernel::EmbreeNative => View {
                kernel,
                isa: super::embree_side::isa(),
                tracer: native.ok_or_else(|| "Embree did not build it".into()),
                counter: None,
            },
            Kernel::EmbreeGrafted => {
                View { kernel, isa: super::embree_side::isa(), tracer: graft.clone(), counter: None }
            }
        };
        if let Some((builds, facts)) = shown.take() {
            observer(Shown { builds, facts, views: visit.kernels.iter().map(view).collect() });
        }
    });
}

/// Small builds are repeated in a visit, until the samples hold 60 ms or are five.
pub(super) fn is_enough(warm: &[Duration]) -> bool {
    warm.len() >= 5 || warm.iter().sum::<Duration>() >= Duration::from_millis(60)
}

/// Milliseconds.
pub(super) fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}
