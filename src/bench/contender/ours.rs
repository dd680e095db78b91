//! Our builders as contenders. The clock runs from the mesh in memory to a traversable tree with its leaf data.

use super::built_tree::{BuildRequest, BuiltTree, EitherWidth};
use super::caught::caught;
use crate::bench::build_times::{BuildTimes, WarmTimes, is_enough, ms};
use crate::bench::cell::{Cell, Kernel};
use crate::bench::cpu_time::{CpuClock, least_disturbed};
use crate::bench::tree_facts::TreeFacts;
use crate::builders::{self, Build, Builder};
use crate::bvh::{Statistics, WideBvh};
use crate::geometry::Mesh;
use rayon::ThreadPool;
use std::convert::Infallible;
use std::time::{Duration, Instant};

/// One of our builders, of trees of nodes of up to `N` children.
pub struct Ours<const N: usize> {
    builder: Box<dyn Builder<N>>,
}

/// The cells of all our builders, traced by `kernels`: those of a table in both widths, those that show single
/// extensions in the paper's.
pub fn cells(kernels: &[Kernel]) -> impl Iterator<Item = Cell> {
    let cell = |name: &str, width| Cell { builder: name.into(), width, kernels: kernels.into() };
    let both = builders::NAMES.iter().flat_map(move |name| [4, 8].map(|width| cell(name, width)));
    both.chain(builders::ABLATION.iter().map(move |name| cell(name, 4)))
}

impl<const N: usize> Ours<N>
where
    EitherWidth: From<WideBvh<N>>,
{
    /// The builder called `name`, new.
    pub fn by_name(name: &str) -> Option<Self> {
        builders::by_name(name).map(Self::new)
    }

    /// Measures `builder`.
    pub fn new(builder: Box<dyn Builder<N>>) -> Self {
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
        BuiltTree { times, facts, mesh, tree: Ok(built.tree.into()), native: None }
    }

    /// Warm builds, repeated while other programs disturb them.
    fn warm(&mut self, pool: &ThreadPool, mesh: &Mesh, built: Build<N>) -> (WarmTimes, Build<N>) {
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
    fn once(
        &mut self,
        pool: &ThreadPool,
        mesh: &Mesh,
        no_longer_needed: Option<Build<N>>,
    ) -> (Duration, Build<N>) {
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
