//! One visit to a cell: its builds, then every batch of recorded rays under every kernel. The first visit
//! verifies each answer; later ones must give the same distances.

mod traces;

use crate::bench::build_times::BuildTimes;
use crate::bench::cell::Cell;
use crate::bench::contender::{BuildRequest, BuiltTree, Contender, TreeUnderKernel};
use crate::bench::cpu_time::CpuClock;
use crate::bench::samples::{CellSamples, KernelChecks, VisitSamples};
use crate::bench::tree_facts::TreeFacts;
pub use traces::SceneTraces;
use traces::Stopped;

/// How often a visit traces all batches under each kernel; the median of the passes is robust against single
/// disturbances.
const PASSES: usize = 3;

/// A scene under measurement.
pub struct Bench<'a> {
    traces: SceneTraces<'a>,
}

/// When a cell is visited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Turn {
    /// The round, from 0.
    pub round: usize,
    /// Place within the round, from 0.
    pub place: usize,
}

/// Why a visit did not come to its end.
#[derive(Debug, PartialEq, Eq)]
enum Unfinished {
    /// The run was told to stop.
    Stopped,
    /// The builder failed.
    Failed(String),
}

impl From<Stopped> for Unfinished {
    fn from(_: Stopped) -> Self {
        Self::Stopped
    }
}

impl From<String> for Unfinished {
    fn from(reason: String) -> Self {
        Self::Failed(reason)
    }
}

impl<'a> Bench<'a> {
    /// Visits trace and compare by `traces`.
    pub fn new(traces: SceneTraces<'a>) -> Self {
        Self { traces }
    }

    /// Visits `cell` in its `turn` and adds the samples to `samples`. A builder that fails leaves its reason
    /// there.
    ///
    /// # Errors
    /// `Stopped` if the run was told to stop meanwhile.
    pub fn visit(&mut self, cell: &Cell, turn: Turn, samples: &mut CellSamples) -> Result<(), Stopped> {
        let visited = Contender::of(cell)
            .map_err(Unfinished::Failed)
            .and_then(|mut contender| self.visit_contender(&mut contender, cell, turn, samples));
        match visited {
            Ok(()) => Ok(()),
            Err(Unfinished::Stopped) => Err(Stopped),
            Err(Unfinished::Failed(reason)) => {
                samples.error = Some(reason);
                Ok(())
            }
        }
    }

    fn visit_contender(
        &mut self,
        contender: &mut Contender,
        cell: &Cell,
        turn: Turn,
        samples: &mut CellSamples,
    ) -> Result<(), Unfinished> {
        let built = self.build(contender, cell, samples.visits.is_empty())?;
        let trees = self.under_kernels(&built, cell)?;
        self.trace((built.times.clone(), built.facts.clone()), trees, turn, samples)?;
        Ok(())
    }

    /// Builds `cell` and traces every batch once, untimed.
    ///
    /// # Errors
    /// A builder that failed, in one line.
    pub fn verify(&mut self, cell: &Cell) -> Result<Vec<KernelChecks>, String> {
        let mut contender = Contender::of(cell)?;
        let built = self.build(&mut contender, cell, true)?;
        let trees = self.under_kernels(&built, cell)?;
        Ok(trees.iter().filter_map(|tree| self.traces.check(tree).ok()).collect())
    }

    fn build<'b>(
        &self,
        contender: &mut Contender,
        cell: &'b Cell,
        wants_facts: bool,
    ) -> Result<BuiltTree<'b>, String>
    where
        'a: 'b,
    {
        let (mesh, pools) = (&self.traces.scene.mesh, self.traces.pools);
        contender.build(&BuildRequest { mesh, pools, kernels: &cell.kernels, wants_facts, fresh_only: false })
    }

    fn under_kernels<'b>(
        &self,
        built: &'b BuiltTree<'_>,
        cell: &Cell,
    ) -> Result<Vec<TreeUnderKernel<'b>>, String> {
        TreeUnderKernel::all(built, &cell.kernels, self.traces.pools.all.current_num_threads())
    }

    /// Traces a tree, just built, under its kernels; facts come with the first visit, which verifies.
    fn trace(
        &mut self,
        (builds, facts): (BuildTimes, Option<TreeFacts>),
        mut trees: Vec<TreeUnderKernel<'_>>,
        turn: Turn,
        samples: &mut CellSamples,
    ) -> Result<(), Stopped> {
        if let Some(facts) = facts {
            samples.facts = facts;
            samples.checks.clear();
            for tree in &trees {
                let checks = self.traces.check(tree)?;
                samples.checks.push(checks);
            }
        }
        // Each kernel is first in its turn.
        let kernels = trees.len().max(1);
        trees.rotate_left(turn.round % kernels);
        let mut timings = Vec::new();
        let clock = CpuClock::read();
        // All passes of a kernel at once: but for the first, each finds the tree in the caches, as far as it fits.
        let passes = trees.iter().flat_map(|tree| (0..PASSES).map(move |pass| (pass, tree)));
        for (pass, tree) in passes {
            let Ok(tracer) = tree.tracer() else { continue };
            let Some(checks) = samples.checks.iter_mut().find(|checks| checks.kernel == tree.kernel) else {
                continue;
            };
            if checks.mismatch.is_none() && checks.unavailable.is_none() {
                timings.extend(self.traces.time(tracer, pass, checks)?);
            }
        }
        let cpu_time = clock.since();
        let Turn { round, place } = turn;
        samples.visits.push(VisitSamples { round, place, builds, timings, cpu_time });
        self.traces.go_on()
    }
}

#[cfg(test)]
mod tests;
