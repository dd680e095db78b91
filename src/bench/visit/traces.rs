//! The recorded rays of a scene, traced by one tree after the other: checked against the reference, then timed.

use crate::bench::contender::TreeUnderKernel;
use crate::bench::pools::Pools;
use crate::bench::rays::{Answers, ViewRays};
use crate::bench::samples::{Check, KernelChecks, Timing};
use crate::bench::settings::Settings;
use crate::geometry::Tracer;
use crate::scene::Scene;
use crate::trace::verify::{self, Mismatch, Verdict};
use crate::trace::{self, RayKind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Pause before each trace, in which the threads of the builder go to sleep.
const SETTLE: Duration = Duration::from_millis(3);

/// The recorded rays of a scene, with memory for the answers.
pub struct SceneTraces<'a> {
    /// The scene.
    pub(super) scene: &'a Scene,
    rays: &'a [ViewRays],
    /// Its hits are the reference; `None` where nothing is traced.
    reference: Option<&'a dyn Tracer>,
    settings: &'a Settings,
    /// The threads.
    pub(super) pools: &'a Pools,
    stop: &'a AtomicBool,
    /// Memory for the answers, reused so that no page is touched for the first time in a timed trace.
    scratch: Vec<Vec<Answers>>,
}

/// The run was told to stop: nothing of the visit is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopped;

impl<'a> SceneTraces<'a> {
    /// Of `rays`, compared with the hits of `reference`, until told to `stop`; allocates the memory for the answers.
    pub fn new(
        scene: &'a Scene,
        rays: &'a [ViewRays],
        reference: Option<&'a dyn Tracer>,
        settings: &'a Settings,
        pools: &'a Pools,
        stop: &'a AtomicBool,
    ) -> Self {
        let scratch = rays.iter().map(|view| view.reference.clone()).collect();
        Self { scene, rays, reference, settings, pools, stop, scratch }
    }

    /// Whether to go on.
    ///
    /// # Errors
    /// `Stopped` if the run was told to stop.
    pub fn go_on(&self) -> Result<(), Stopped> {
        if self.stop.load(Ordering::Relaxed) { Err(Stopped) } else { Ok(()) }
    }

    /// Traces each batch once, untimed, and compares with the reference.
    ///
    /// # Errors
    /// `Stopped` if the run was told to stop meanwhile.
    pub fn check(&mut self, tree: &TreeUnderKernel<'_>) -> Result<KernelChecks, Stopped> {
        let mut kernel = KernelChecks {
            kernel: tree.kernel,
            isa: tree.isa.clone(),
            unavailable: None,
            checks: Vec::new(),
            mismatch: None,
        };
        let tracer = match tree.tracer() {
            Ok(tracer) => tracer,
            Err(reason) => {
                kernel.unavailable = Some(reason.to_owned());
                return Ok(kernel);
            }
        };
        for (index, view_rays) in self.rays.iter().enumerate() {
            for (slot, kind) in RayKind::ALL.into_iter().enumerate() {
                self.go_on()?;
                let rays = view_rays.batches.get(kind);
                let answers = &mut self.scratch[index][slot];
                answers.reset();
                self.pools.all.install(|| answers.fill(tracer, rays));
                let verdict = self.verdict(tracer, index, slot);
                let answers = &self.scratch[index][slot];
                let counts = self.pools.all.install(|| tree.count(kind, rays));
                kernel.checks.push(Check {
                    view: index,
                    kind: Some(kind),
                    rays: rays.len() as u64,
                    hits: answers.hits(),
                    hash: format!("{:016x}", answers.hash()),
                    equal: verdict.equal as u64,
                    ties: verdict.ties as u64,
                    edge: verdict.edge as u64,
                    near_misses: verdict.near_misses as u64,
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
        kernel.mismatch = kernel.excess();
        Ok(kernel)
    }

    /// Compares the answers of `tracer` to a batch with the reference's.
    fn verdict(&self, tracer: &dyn Tracer, view: usize, slot: usize) -> Verdict {
        let rays = self.rays[view].batches.get(RayKind::ALL[slot]);
        let (answers, right) = (&self.scratch[view][slot], &self.rays[view].reference[slot]);
        let tracers = [self.reference.unwrap_or(tracer), tracer];
        self.pools.all.install(|| answers.compare(&self.scene.mesh, rays, right, tracers))
    }

    /// Times each batch, and in the first pass frames where they are asked for. Answers whose hash differs from the
    /// first trace's are compared with the reference again: trees of parallel builders may differ, but every hit must
    /// be right, and no more of them excused than in the first.
    ///
    /// # Errors
    /// `Stopped` if the run was told to stop meanwhile.
    pub fn time(
        &mut self,
        tracer: &dyn Tracer,
        pass: usize,
        checks: &mut KernelChecks,
    ) -> Result<Vec<Timing>, Stopped> {
        let mut timings = Vec::new();
        for (index, view_rays) in self.rays.iter().enumerate() {
            for (slot, kind) in RayKind::ALL.into_iter().enumerate() {
                self.go_on()?;
                let rays = view_rays.batches.get(kind);
                let answers = &mut self.scratch[index][slot];
                answers.reset();
                std::thread::sleep(SETTLE);
                let start = Instant::now();
                self.pools.all.install(|| answers.fill(tracer, rays));
                let ms = start.elapsed().as_secs_f64() * 1e3;
                timings.push(Timing { kernel: checks.kernel, view: index, kind: Some(kind), pass, ms });

                let first =
                    checks.checks.iter().find(|check| check.view == index && check.kind == Some(kind));
                if first.is_none_or(|first| first.hash != format!("{:016x}", answers.hash())) {
                    let verdict = self.verdict(tracer, index, slot);
                    let [edges, near_misses] = [verdict.edge, verdict.near_misses].map(|count| count as u64);
                    let excess = verify::excess(rays.len() as u64, edges, near_misses, checks.excused());
                    if let Some(wrong) = verdict.mismatches.first().map(Mismatch::to_string).or(excess) {
                        checks.mismatch =
                            Some(format!("view {index}, {}: in a later round {wrong}", kind.name()));
                        return Ok(timings);
                    }
                }
            }
            if self.settings.frames && pass == 0 {
                let view = &self.scene.views[index];
                std::thread::sleep(SETTLE);
                let start = Instant::now();
                let path = self.settings.path();
                let image = self.pools.all.install(|| trace::render(tracer, &self.scene.mesh, view, &path));
                let ms = start.elapsed().as_secs_f64() * 1e3;
                drop(image);
                timings.push(Timing { kernel: checks.kernel, view: index, kind: None, pass, ms });
            }
        }
        Ok(timings)
    }
}
