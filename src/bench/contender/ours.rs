//! Our builders as contenders. The clock runs from the mesh in memory to a traversable tree with its leaf data.

use super::built_tree::{BuildRequest, BuiltTree, EitherWidth};
use super::caught::caught;
use crate::bench::build_times::{BuildTimes, WarmTimes, is_enough, ms};
use crate::bench::cell::{Cell, Kernel};
use crate::bench::cpu_time::{CpuClock, least_disturbed};
use crate::bench::tree_facts::TreeFacts;
use crate::builders::{self, Build, Builder};
use crate::bvh::Statistics;
use crate::geometry::Mesh;
use rayon::ThreadPool;
use std::convert::Infallible;
use std::time::{Duration, Instant};

/// One of our builders.
pub struct Ours {
    builder: Box<dyn Builder>,
}

/// The cells of all our builders, traced by `kernels`.
pub fn cells(kernels: &[Kernel]) -> impl Iterator<Item = Cell> {
    let names = builders::NAMES.iter().chain(builders::ABLATION);
    names.map(|name| Cell { builder: (*name).into(), width: 4, kernels: kernels.into() })
}

impl Ours {
    /// The builder called `name`, new.
    pub fn by_name(name: &str) -> Option<Self> {
        builders::by_name(name).map(Self::new)
    }

    /// Measures `builder`.
    pub fn new(builder: Box<dyn Builder>) -> Self {
        Self { builder }
    }

    /// Builds once cold and then warm, on one thread too where the request has a pool of one.
    ///
    /// # Errors
    /// The message of a builder that panicked.
    pub fn build<'a>(&mut self, request: &BuildRequest<'a>) -> Result<BuiltTree<'a>, String> {
        caught("the builder", || self.cold_and_warm(request))
    }

    fn cold_and_warm<'a>(&mut self, request: &BuildRequest<'a>) -> BuiltTree<'a> {
        let BuildRequest { mesh, pools, .. } = *request;
        let (cold, mut built) = self.once(&pools.all, mesh, None);
        let mut one_thread = None;
        if let Some(pool) = &pools.one {
            let (warm, next) = self.warm(pool, mesh, built);
            (one_thread, built) = (Some(warm), next);
        }
        let (warm, built) = self.warm(&pools.all, mesh, built);
        let times = BuildTimes {
            cold_ms: ms(cold),
            warm,
            phases: built.phases.iter().map(|phase| (phase.name.into(), ms(phase.duration))).collect(),
            peak_bytes: Some(built.counts.peak_bytes).filter(|&bytes| bytes > 0),
            one_thread,
        };
        let facts = request.wants_facts.then(|| {
            let engine = format!("phr {}", env!("CARGO_PKG_VERSION"));
            let statistics = pools.all.install(|| Statistics::of(&built.tree, mesh));
            TreeFacts::of(&statistics, engine, self.builder.config().to_string())
        });
        BuiltTree { times, facts, mesh, tree: Ok(EitherWidth::Four(built.tree)), native: None }
    }

    /// Warm builds, repeated while other programs disturb them.
    fn warm(&mut self, pool: &ThreadPool, mesh: &Mesh, built: Build) -> (WarmTimes, Build) {
        let mut last = Some(built);
        let Ok((ms, cpu_time)) = least_disturbed(|| {
            let clock = CpuClock::read();
            let mut warm = Vec::new();
            while !is_enough(&warm) {
                let (duration, next) = self.once(pool, mesh, last.take());
                warm.push(duration);
                last = Some(next);
            }
            Ok::<_, Infallible>((warm.into_iter().map(ms).collect(), clock.since()))
        });
        (WarmTimes { ms, cpu_time }, last.expect("there was a build"))
    }

    /// One build, in the memory of the tree before it if there is one.
    fn once(&mut self, pool: &ThreadPool, mesh: &Mesh, no_longer_needed: Option<Build>) -> (Duration, Build) {
        pool.install(|| {
            if let Some(Build { tree, .. }) = no_longer_needed {
                self.builder.recycle(tree);
            }
            let start = Instant::now();
            let built = self.builder.build(mesh);
            (start.elapsed(), built)
        })
    }
}
