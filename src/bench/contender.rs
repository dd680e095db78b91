//! Who is measured: a cell is a builder at a width with the kernels that trace its tree. A contender builds
//! in its own way, in its own clock, and shows the finished tree to the observer who traces it.

use super::build_times::{BuildTimes, OneThreadTimes};
use super::cell::{Cell, Kernel, place};
use super::cpu_time::{CpuClock, least_disturbed};
use super::pools::Pools;
use super::tree_facts::TreeFacts;
use crate::builders::{self, Build, Builder};
use crate::bvh::{Statistics, WideBvh};
use crate::geometry::{Mesh, Ray, Tracer};
use crate::trace::{self, BvhTracer, RayKind, TraversalCounts};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::convert::Infallible;
use std::time::{Duration, Instant};

/// All cells of this program, in the table's order.
pub fn cells(build_only: bool) -> Vec<Cell> {
    let ours = builders::NAMES.iter().chain(builders::ABLATION).map(|name| Cell {
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
    /// The threads.
    pub pools: &'a Pools,
    /// Kernels wanted.
    pub kernels: &'a [Kernel],
    /// Whether facts are wanted (they take time, untimed).
    pub facts: bool,
}

/// What a contender shows when its tree stands.
pub struct Shown<'a> {
    /// Durations.
    pub builds: BuildTimes,
    /// TreeFacts, if wanted.
    pub facts: Option<TreeFacts>,
    /// The tree under each kernel wanted.
    pub views: Vec<View<'a>>,
}

/// BuildTimes `cell`'s tree, once cold and then warm, and shows it; it is gone when this returns.
///
/// # Errors
/// A builder that failed or was not the one asked for, in one line.
pub fn visit(cell: &Cell, visit: &Visit<'_>, observer: &mut dyn FnMut(Shown<'_>)) -> Result<(), String> {
    match builders::by_name(&cell.builder) {
        Some(builder) => {
            ours(builder, visit, observer);
            Ok(())
        }
        None => super::embree_side::visit(cell, visit, observer),
    }
}

/// Our side: in the clock is what leads from the mesh in memory to a traversable tree with its leaf data.
fn ours(mut builder: Box<dyn Builder>, visit: &Visit<'_>, observer: &mut dyn FnMut(Shown<'_>)) {
    // Each build has the memory of the tree before it; the first has none.
    let mut build = |pool: &ThreadPool, no_longer_needed: Option<Build>| {
        pool.install(|| {
            if let Some(Build { tree, .. }) = no_longer_needed {
                builder.recycle(tree);
            }
            let start = Instant::now();
            let built = builder.build(visit.mesh);
            (start.elapsed(), built)
        })
    };
    let (cold, mut built) = build(&visit.pools.all, None);
    let mut repeat = |pool: &ThreadPool, built: Build| {
        let mut last = Some(built);
        let measured = least_disturbed(|| {
            let accounts = CpuClock::read();
            let mut warm = Vec::new();
            while !is_enough(&warm) {
                let (duration, next) = build(pool, last.take());
                warm.push(duration);
                last = Some(next);
            }
            Ok::<_, Infallible>((warm.into_iter().map(ms).collect(), accounts.since()))
        });
        let Ok((warm_ms, load)) = measured;
        (warm_ms, load, last.expect("there was a build"))
    };
    let one_thread;
    (one_thread, built) = match &visit.pools.one {
        Some(pool) => {
            let (warm_ms, load, built) = repeat(pool, built);
            (Some(OneThreadTimes { warm_ms, load }), built)
        }
        None => (None, built),
    };
    let (warm_ms, load, built) = repeat(&visit.pools.all, built);
    let builds = BuildTimes {
        cold_ms: ms(cold),
        warm_ms,
        phases: built.phases.iter().map(|phase| (phase.name.into(), ms(phase.duration))).collect(),
        peak_bytes: Some(built.counts.peak_bytes).filter(|&bytes| bytes > 0),
        load,
        one_thread,
    };
    let facts = visit.facts.then(|| {
        let engine = format!("phr {}", env!("CARGO_PKG_VERSION"));
        let statistics = visit.pools.all.install(|| Statistics::of(&built.tree, visit.mesh));
        TreeFacts::of(&statistics, engine, builder.config().to_string())
    });
    present(visit, Ok(&built.tree), None, builds, facts, observer);
}

/// Shows a tree under each kernel wanted: `tree` in our form, or why it cannot be had so; `native` is
/// Embree's own scene, if Embree built it.
pub(super) fn present<const N: usize>(
    visit: &Visit<'_>,
    tree: Result<&WideBvh<N>, String>,
    native: Option<&dyn Tracer>,
    builds: BuildTimes,
    facts: Option<TreeFacts>,
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
                isa: trace::kernel_isa().name().into(),
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
