//! Our builders as contenders. The clock runs from the mesh in memory to a traversable tree with its leaf data.

use super::built_tree::{BuildRequest, BuiltTree, EitherWidth};
use super::caught::caught;
use super::repeated::{timed, warm};
use crate::bench::build_times::{BuildTimes, ms};
use crate::bench::cell::{Cell, Kernel};
use crate::bench::tree_facts::TreeFacts;
use crate::builders::{self, Builder};
use crate::bvh::{Statistics, WideBvh, sah_cost};
use crate::geometry::Mesh;
use rayon::ThreadPool;

/// Makes a new builder object.
type Make<const N: usize> = dyn Fn() -> Box<dyn Builder<N>> + Send + Sync;

/// One of our builders, of trees of nodes of up to `N` children.
pub struct Ours<const N: usize> {
    make: Box<Make<N>>,
}

/// The cells of all our builders, traced by `kernels`: those of a table in both widths, those that show single
/// extensions in the paper's.
pub fn cells(kernels: &[Kernel]) -> impl Iterator<Item = Cell> {
    let cell = |name: &str, width| Cell::new(name, width, kernels);
    let both = builders::NAMES.iter().flat_map(move |name| [4, 8].map(|width| cell(name, width)));
    both.chain(builders::on_request().map(move |name| cell(name, 4)))
}

impl<const N: usize> Ours<N>
where
    EitherWidth: From<WideBvh<N>>,
{
    /// The builder called `name`.
    pub fn by_name(name: &str) -> Option<Self> {
        builders::by_name::<N>(name)?;
        let name = name.to_owned();
        Some(Self::new(move || builders::by_name(&name).expect("there is such a builder, as just seen")))
    }

    /// Measures the builders that `make` makes.
    pub fn new(make: impl Fn() -> Box<dyn Builder<N>> + Send + Sync + 'static) -> Self {
        Self { make: Box::new(make) }
    }

    /// Builds in each regime, on one thread too where the request has a pool of one.
    ///
    /// # Errors
    /// The message of a builder that panicked.
    pub fn build<'a>(&mut self, request: &BuildRequest<'a>) -> Result<BuiltTree<'a>, String> {
        caught("the builder", || self.in_each_regime(request))?
    }

    /// Builds once, untimed; only the tree is kept.
    ///
    /// # Errors
    /// The message of a builder that panicked.
    pub fn once<'a>(&self, mesh: &'a Mesh, pool: &ThreadPool) -> Result<BuiltTree<'a>, String> {
        let built = caught("the builder", || pool.install(|| (self.make)().build(mesh)))?;
        let tree = Ok(built.tree.into());
        Ok(BuiltTree { times: BuildTimes::default(), facts: None, mesh, tree, native: None })
    }

    /// Fresh builds alone.
    fn fresh<'a>(&self, mesh: &'a Mesh, pool: &ThreadPool) -> BuiltTree<'a> {
        let mut last = None;
        let fresh = warm(|| {
            last = None;
            let (duration, built) = timed(pool, || (self.make)().build(mesh));
            last = Some(built);
            duration
        });
        let built = last.expect("there was a build");
        let times = BuildTimes { fresh, ..BuildTimes::default() };
        BuiltTree { times, facts: None, mesh, tree: Ok(built.tree.into()), native: None }
    }

    fn in_each_regime<'a>(&self, request: &BuildRequest<'a>) -> Result<BuiltTree<'a>, String> {
        let BuildRequest { mesh, pools, .. } = *request;
        if request.fresh_only {
            return Ok(self.fresh(mesh, &pools.all));
        }
        let mut builder = (self.make)();
        let (first, built) = timed(&pools.all, || builder.build(mesh));
        let mut last = Some(built);
        let rebuild = warm(|| {
            last.take().into_iter().for_each(|built| builder.recycle(built.tree));
            let (duration, built) = timed(&pools.all, || builder.build(mesh));
            last = Some(built);
            duration
        });
        let rebuilt = request.wants_facts.then(|| last.as_ref().map(|built| sah_cost(&built.tree)));
        drop((builder, last.take()));
        let mut fresh = |pool: &ThreadPool| {
            warm(|| {
                // Outside the clock, as Embree's scenes. The builder's memory is freed inside, as Embree's is.
                last = None;
                let (duration, built) = timed(pool, || (self.make)().build(mesh));
                last = Some(built);
                duration
            })
        };
        let one_thread = pools.one.as_ref().map(&mut fresh);
        let fresh = fresh(&pools.all);
        let built = last.expect("there was a build");
        let times = BuildTimes {
            first_ms: ms(first),
            fresh,
            rebuild,
            dynamic_rebuild: None,
            phases: built.phases.iter().map(|phase| (phase.name.into(), ms(phase.duration))).collect(),
            one_thread,
        };
        let facts = request.wants_facts.then(|| {
            let engine = format!("phr {}", env!("CARGO_PKG_VERSION"));
            let statistics = pools.all.install(|| Statistics::of(&built.tree, mesh));
            TreeFacts::of(&statistics, engine, (self.make)().config().to_string())
        });
        if let (Some(Some(rebuilt)), Some(fresh)) = (rebuilt, facts.as_ref().and_then(|facts| facts.sah))
            && rebuilt != fresh
        {
            return Err(format!("a tree built again has a SAH cost of {rebuilt}, a fresh one {fresh}"));
        }
        Ok(BuiltTree { times, facts, mesh, tree: Ok(built.tree.into()), native: None })
    }
}
