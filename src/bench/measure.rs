//! One visit to a cell: builds in the builder's own clock, then every batch of recorded rays through every
//! kernel. The first visit verifies each answer; every later one must hash to the same distances.

use super::contender::{self, Cell, Shown, View, Visit};
use super::load::Accounts;
use super::plan::Settings;
use super::rays::{Answers, ViewRays};
use super::samples::{CellSamples, Check, KernelChecks, Timing, VisitSamples};
use crate::geometry::Tracer;
use crate::scene::Scene;
use crate::trace::verify::Verdict;
use crate::trace::{self, RayKind};
use rayon::ThreadPool;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Pause before each trace, in which the threads of the builder go to sleep.
const SETTLE: Duration = Duration::from_millis(3);

/// A scene under measurement.
pub struct Bench<'a> {
    scene: &'a Scene,
    rays: &'a [ViewRays],
    /// Whose hits are right; absent where nothing is traced.
    reference: Option<&'a dyn Tracer>,
    settings: &'a Settings,
    pool: &'a ThreadPool,
    stop: &'a AtomicBool,
    /// Where tracers write, kept so that no page is touched for the first time in a timed trace.
    scratch: Vec<Vec<Answers>>,
}

/// The visit was broken off: nothing of it is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopped;

impl<'a> Bench<'a> {
    /// Makes room for the answers.
    pub fn new(
        scene: &'a Scene,
        rays: &'a [ViewRays],
        reference: Option<&'a dyn Tracer>,
        settings: &'a Settings,
        pool: &'a ThreadPool,
        stop: &'a AtomicBool,
    ) -> Self {
        let scratch = rays.iter().map(|view| view.reference.clone()).collect();
        Self { scene, rays, reference, settings, pool, stop, scratch }
    }

    /// Visits `cell` in `round`, as the `place`-th of it, and adds the samples to `samples`. A builder that
    /// fails leaves its reason there.
    ///
    /// # Errors
    /// [`Stopped`] if the run was told to stop meanwhile.
    pub fn visit(
        &mut self,
        cell: &Cell,
        round: usize,
        place: usize,
        samples: &mut CellSamples,
    ) -> Result<(), Stopped> {
        let visit = Visit {
            mesh: &self.scene.mesh,
            pool: self.pool,
            kernels: &cell.kernels,
            facts: samples.visits.is_empty(),
        };
        let mut done = Ok(());
        let built = contender::visit(cell, &visit, &mut |shown| {
            done = self.trace(shown, round, place, samples);
        });
        if let Err(reason) = built {
            samples.error = Some(reason);
        }
        done
    }

    /// Builds `cell` and traces every batch once, untimed.
    ///
    /// # Errors
    /// A builder that failed, in one line.
    pub fn verify(&mut self, cell: &Cell) -> Result<Vec<KernelChecks>, String> {
        let visit = Visit { mesh: &self.scene.mesh, pool: self.pool, kernels: &cell.kernels, facts: true };
        let mut checks = Vec::new();
        contender::visit(cell, &visit, &mut |shown| {
            checks = shown.views.iter().filter_map(|view| self.check(view).ok()).collect();
        })?;
        Ok(checks)
    }

    fn trace(
        &mut self,
        mut shown: Shown<'_>,
        round: usize,
        place: usize,
        samples: &mut CellSamples,
    ) -> Result<(), Stopped> {
        if let Some(facts) = shown.facts.take() {
            samples.facts = facts;
            samples.checks.clear();
            for view in &shown.views {
                let checks = self.check(view)?;
                samples.checks.push(checks);
            }
        }
        // Each kernel is first in its turn.
        let kernels = shown.views.len().max(1);
        shown.views.rotate_left(round % kernels);
        let mut timings = Vec::new();
        let accounts = Accounts::read();
        for view in &shown.views {
            let Ok(tracer) = view.tracer else { continue };
            let Some(checks) = samples.checks.iter_mut().find(|checks| checks.kernel == view.kernel) else {
                continue;
            };
            if checks.mismatch.is_none() && checks.unavailable.is_none() {
                timings.extend(self.time(tracer, checks)?);
            }
        }
        let load = accounts.since();
        samples.visits.push(VisitSamples { round, place, builds: shown.builds, timings, load });
        self.go_on()
    }

    fn go_on(&self) -> Result<(), Stopped> {
        if self.stop.load(Ordering::Relaxed) { Err(Stopped) } else { Ok(()) }
    }

    /// Traces each batch once, untimed, and compares with the reference.
    fn check(&mut self, view: &View<'_>) -> Result<KernelChecks, Stopped> {
        let mut kernel = KernelChecks {
            kernel: view.kernel,
            isa: view.isa.clone(),
            unavailable: None,
            checks: Vec::new(),
            mismatch: None,
        };
        let tracer = match &view.tracer {
            Ok(tracer) => *tracer,
            Err(reason) => {
                kernel.unavailable = Some(reason.clone());
                return Ok(kernel);
            }
        };
        for (index, view_rays) in self.rays.iter().enumerate() {
            for (slot, kind) in RayKind::ALL.into_iter().enumerate() {
                self.go_on()?;
                let rays = view_rays.batches.get(kind);
                let answers = &mut self.scratch[index][slot];
                answers.reset();
                self.pool.install(|| answers.fill(tracer, rays));
                let verdict = self.verdict(tracer, index, slot);
                let answers = &self.scratch[index][slot];
                let counts = view.counter.map(|counter| self.pool.install(|| counter.count(kind, rays)));
                kernel.checks.push(Check {
                    view: index,
                    kind: Some(kind),
                    rays: rays.len() as u64,
                    hits: answers.hits(),
                    hash: format!("{:016x}", answers.hash()),
                    equal: verdict.equal as u64,
                    ties: verdict.ties as u64,
                    edge: verdict.edge as u64,
                    node_visits: counts.map(|counts| counts.node_visits),
                    block_tests: counts.map(|counts| counts.block_tests),
                });
                if let Some(first) = verdict.mismatches.first() {
                    let wrong = verdict.mismatched;
                    kernel.mismatch = Some(format!(
                        "view {index}, {}: {wrong} of {} answers are wrong, first {first}",
                        kind.name(),
                        rays.len()
                    ));
                    return Ok(kernel);
                }
            }
        }
        Ok(kernel)
    }

    /// Compares the answers of `tracer` to a batch with the reference's.
    fn verdict(&self, tracer: &dyn Tracer, view: usize, slot: usize) -> Verdict {
        let rays = self.rays[view].batches.get(RayKind::ALL[slot]);
        let (answers, right) = (&self.scratch[view][slot], &self.rays[view].reference[slot]);
        let tracers = [self.reference.unwrap_or(tracer), tracer];
        self.pool.install(|| answers.compare(&self.scene.mesh, rays, right, tracers))
    }

    /// Traces each batch against the clock. Answers that hash to other distances than at first are compared
    /// again: trees of parallel builders may differ, but not so that a hit is wrong.
    fn time(&mut self, tracer: &dyn Tracer, checks: &mut KernelChecks) -> Result<Vec<Timing>, Stopped> {
        let mut timings = Vec::new();
        for (index, view_rays) in self.rays.iter().enumerate() {
            for (slot, kind) in RayKind::ALL.into_iter().enumerate() {
                self.go_on()?;
                let rays = view_rays.batches.get(kind);
                let answers = &mut self.scratch[index][slot];
                answers.reset();
                std::thread::sleep(SETTLE);
                let start = Instant::now();
                self.pool.install(|| answers.fill(tracer, rays));
                let ms = start.elapsed().as_secs_f64() * 1e3;
                timings.push(Timing { kernel: checks.kernel, view: index, kind: Some(kind), ms });

                let first =
                    checks.checks.iter().find(|check| check.view == index && check.kind == Some(kind));
                if first.is_none_or(|first| first.hash != format!("{:016x}", answers.hash())) {
                    let verdict = self.verdict(tracer, index, slot);
                    if let Some(wrong) = verdict.mismatches.first() {
                        checks.mismatch =
                            Some(format!("view {index}, {}: in a later round {wrong}", kind.name()));
                        return Ok(timings);
                    }
                }
            }
            if self.settings.frames {
                let view = &self.scene.views[index];
                std::thread::sleep(SETTLE);
                let start = Instant::now();
                let path = self.settings.path();
                let image = self.pool.install(|| trace::render(tracer, &self.scene.mesh, view, &path));
                let ms = start.elapsed().as_secs_f64() * 1e3;
                drop(image);
                timings.push(Timing { kernel: checks.kernel, view: index, kind: None, ms });
            }
        }
        Ok(timings)
    }
}
