//! Quick measurements, for decisions and not for records: a few fresh builds and one pass over a few recorded rays
//! a visit, every answer verified at first. [`line`](mod@line) is what they tell of a tree, [`survey`] measures all
//! trees of a scene within a time and drops those that surely win nowhere, [`tune`] searches parameters.

pub mod line;
pub mod survey;
pub mod tune;

use super::cell::{Cell, Kernel};
use super::contender::{self, BuildRequest, BuiltTree, Contender, REFERENCE_KERNEL, TreeUnderKernel};
use super::pools::Pools;
use super::rays::{self, ViewRays};
use super::samples::KernelChecks;
use super::settings::Settings;
use super::statistics::median;
use super::visit::SceneTraces;
use crate::scene::Scene;
use crate::trace::RayKind;
use std::sync::atomic::AtomicBool;

/// Pixels across and down of the recorded views.
const PIXELS: u32 = 128;
/// Views recorded.
const VIEWS: usize = 3;

/// What one visit measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuickVisit {
    /// Median of fresh builds, ms.
    pub build_ms: f64,
    /// All recorded rays, ns per ray.
    pub ns_per_ray: f64,
}

/// A scene ready to be measured.
pub struct Quick<'a> {
    scene: &'a Scene,
    pools: &'a Pools,
    kernel: Kernel,
    rays: u64,
    recorded: &'a [ViewRays],
    traces: SceneTraces<'a>,
    checked: Vec<(Cell, KernelChecks)>,
}

/// Has `measure` measure `scene` with `threads`; the paths of the recorded rays depend on `seed`. Trees are traced by
/// `kernel`.
///
/// # Errors
/// No threads, or no reference tree, in one line.
pub fn quickly<T>(
    scene: &Scene,
    (threads, kernel, seed): (usize, Kernel, u64),
    measure: impl FnOnce(&mut Quick<'_>) -> T,
) -> Result<T, String> {
    let settings = Settings { seed, ..Settings::new(PIXELS, VIEWS, 1, threads) };
    let pools = Pools::new(&settings).map_err(|error| format!("--threads {threads}: {error}; give fewer"))?;
    let built = contender::reference(&scene.mesh, &pools.all)?;
    let tree = TreeUnderKernel::new(&built, REFERENCE_KERNEL, threads)?;
    let reference = tree.tracer().map_err(str::to_owned)?;
    let recorded = pools.all.install(|| rays::record(reference, scene, &settings));
    let rays = recorded.iter().map(|view| view.batches.len() as u64).sum();
    if rays == 0 {
        return Err(format!("{}: its views record no rays; give cameras in views.json", scene.name));
    }
    let stop = AtomicBool::new(false);
    let traces = SceneTraces::new(scene, &recorded, Some(reference), &settings, &pools, &stop);
    let (pools, recorded) = (&pools, &recorded[..]);
    Ok(measure(&mut Quick { scene, pools, kernel, rays, recorded, traces, checked: Vec::new() }))
}

impl Quick<'_> {
    /// The scene.
    pub fn scene(&self) -> &Scene {
        self.scene
    }

    /// Builds `cell` a few times, each with a new builder in new memory, and traces all rays once; verifies every
    /// answer at the first visit.
    ///
    /// # Errors
    /// A builder that failed, a kernel that cannot have the tree, or wrong hits, in one line.
    pub fn visit(&mut self, cell: &Cell) -> Result<QuickVisit, String> {
        self.visit_or_count(cell, false).map(|(visit, _)| visit)
    }

    /// As [`Quick::visit`]; then counts the inner nodes that a ray visits, where our kernel can trace the tree.
    ///
    /// # Errors
    /// Those of [`Quick::visit`].
    pub fn visit_and_count(&mut self, cell: &Cell) -> Result<(QuickVisit, Option<f64>), String> {
        self.visit_or_count(cell, true)
    }

    fn visit_or_count(&mut self, cell: &Cell, counts: bool) -> Result<(QuickVisit, Option<f64>), String> {
        let kernels = [self.kernel];
        let request = BuildRequest {
            mesh: &self.scene.mesh,
            pools: self.pools,
            kernels: &kernels,
            wants_facts: false,
            fresh_only: true,
        };
        let built = Contender::of(cell)?.build(&request)?;
        let build_ms = median(&built.times.fresh.ms).ok_or("the builder was not timed")?;
        let tree = TreeUnderKernel::new(&built, self.kernel, self.pools.all.current_num_threads())?;
        let tracer = tree.tracer().map_err(str::to_owned)?;
        let known = self.checked.iter().position(|(known, _)| known == cell);
        let index = match known {
            Some(index) => index,
            None => {
                let checks = self.traces.check(&tree).map_err(|_| "stopped")?;
                self.checked.push((cell.clone(), checks));
                self.checked.len() - 1
            }
        };
        let checks = &mut self.checked[index].1;
        if checks.mismatch.is_none() {
            let timings = self.traces.time(tracer, 0, checks).map_err(|_| "stopped")?;
            if checks.mismatch.is_none() {
                let ms: f64 = timings.iter().map(|timing| timing.ms).sum();
                let nodes = if counts { self.nodes_per_ray(&built) } else { None };
                return Ok((QuickVisit { build_ms, ns_per_ray: 1e6 * ms / self.rays as f64 }, nodes));
            }
        }
        Err(format!("wrong hits: {}", checks.mismatch.clone().unwrap_or_default()))
    }

    /// The inner nodes that a ray visits under our kernel, the mean over all recorded rays.
    fn nodes_per_ray(&self, built: &BuiltTree<'_>) -> Option<f64> {
        let tree = TreeUnderKernel::new(built, Kernel::Phr, self.pools.all.current_num_threads()).ok()?;
        let mut nodes = 0;
        for view in self.recorded {
            for kind in RayKind::ALL {
                let counts = self.pools.all.install(|| tree.count(kind, view.batches.get(kind)))?;
                nodes += counts.node_visits;
            }
        }
        Some(nodes as f64 / self.rays as f64)
    }
}
