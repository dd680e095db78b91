//! Builders of other crates as contenders. The clock runs from the crate's own form of the mesh to its own structure;
//! neither the form nor our wide tree of the structure is on it.

use super::built_tree::{BuildRequest, BuiltTree, EitherWidth};
use super::caught::caught;
use super::repeated::{timed, warm};
use crate::bench::build_times::{BuildTimes, ms};
use crate::bench::cell::{Cell, Kernel};
use crate::bench::tree_facts::TreeFacts;
use crate::builders::widened;
use crate::bvh::{Statistics, WideBvh};
use crate::geometry::Mesh;
use crate::peers::{Obvhs, Peer, Svenstaro};
use rayon::ThreadPool;

/// A builder of another crate whose trees are widened to one width.
pub trait Contestant: Send {
    /// Builds in each regime; memory is the crate's affair, so that building again is building afresh.
    ///
    /// # Errors
    /// The message of a builder that panicked, or why its tree cannot be widened.
    fn build<'a>(&mut self, request: &BuildRequest<'a>) -> Result<BuiltTree<'a>, String>;

    /// Builds once, untimed.
    ///
    /// # Errors
    /// As [`Contestant::build`].
    fn once<'a>(&self, mesh: &'a Mesh, pool: &ThreadPool) -> Result<BuiltTree<'a>, String>;
}

/// The cells of all crates, traced by `kernels`, in both widths.
pub fn cells(kernels: &[Kernel]) -> Vec<Cell> {
    let names = Obvhs::ALL.iter().map(Peer::name).chain([Svenstaro.name()]);
    let cell = |name: &str, width| Cell::new(name, width, kernels);
    names.flat_map(|name| [4, 8].map(|width| cell(name, width))).collect()
}

/// The builder of `cell`, if it is of another crate.
pub fn of(cell: &Cell) -> Option<Box<dyn Contestant>> {
    match (Obvhs::ALL.into_iter().find(|peer| peer.name() == cell.builder), cell.width) {
        (Some(peer), 4) => Some(Box::new(Measured::<_, 4>(peer))),
        (Some(peer), 8) => Some(Box::new(Measured::<_, 8>(peer))),
        (None, 4) if cell.builder == Svenstaro.name() => Some(Box::new(Measured::<_, 4>(Svenstaro))),
        (None, 8) if cell.builder == Svenstaro.name() => Some(Box::new(Measured::<_, 8>(Svenstaro))),
        _ => None,
    }
}

struct Measured<P, const N: usize>(P);

impl<P: Peer + Send + Sync, const N: usize> Contestant for Measured<P, N>
where
    P::Input: Send,
    P::Built: Sync,
    EitherWidth: From<WideBvh<N>>,
{
    fn build<'a>(&mut self, request: &BuildRequest<'a>) -> Result<BuiltTree<'a>, String> {
        let BuildRequest { mesh, pools, .. } = *request;
        caught("the builder", || {
            let mut input = self.0.input(mesh);
            let mut last = None;
            let mut build = |pool: &ThreadPool| {
                // Outside the clock, as for the others.
                last = None;
                let (duration, built) = timed(pool, || self.0.build(&mut input));
                last = Some(built);
                duration
            };
            if request.fresh_only {
                let times = BuildTimes { fresh: warm(|| build(&pools.all)), ..BuildTimes::default() };
                let tree = Ok(self.widened(&last.expect("there was a build"), mesh)?.into());
                return Ok(BuiltTree { times, facts: None, mesh, tree, native: None });
            }
            let first = build(&pools.all);
            let rebuild = warm(|| build(&pools.all));
            let one_thread = pools.one.as_ref().map(|one| warm(|| build(one)));
            let fresh = warm(|| build(&pools.all));
            let tree = self.widened(&last.expect("there was a build"), mesh)?;
            let phases = Vec::new();
            let first_ms = ms(first);
            let times = BuildTimes { first_ms, fresh, rebuild, dynamic_rebuild: None, phases, one_thread };
            let facts = request.wants_facts.then(|| {
                let statistics = pools.all.install(|| Statistics::of(&tree, mesh));
                TreeFacts::of(&statistics, self.0.engine(), self.0.config().to_string())
            });
            Ok(BuiltTree { times, facts, mesh, tree: Ok(tree.into()), native: None })
        })?
    }

    fn once<'a>(&self, mesh: &'a Mesh, pool: &ThreadPool) -> Result<BuiltTree<'a>, String> {
        let tree = caught("the builder", || {
            let (_, built) = timed(pool, || self.0.build(&mut self.0.input(mesh)));
            self.widened(&built, mesh)
        })??;
        let tree = Ok(tree.into());
        Ok(BuiltTree { times: BuildTimes::default(), facts: None, mesh, tree, native: None })
    }
}

impl<P: Peer, const N: usize> Measured<P, N> {
    fn widened(&self, built: &P::Built, mesh: &Mesh) -> Result<WideBvh<N>, String> {
        widened(&self.0.tree(built), mesh)
    }
}
