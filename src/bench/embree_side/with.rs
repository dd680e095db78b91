//! The driver's view of Embree where it is there.

use crate::bench::build_times::{BuildTimes, OneThreadTimes};
use crate::bench::cell::{Cell, Kernel};
use crate::bench::contender::{Shown, Visit, is_enough, ms, present};
use crate::bench::cpu_time::{CpuClock, CpuTime, least_disturbed};
use crate::bench::environment::Library;
use crate::bench::tree_facts::TreeFacts;
use crate::bvh::{Statistics, WideBvh};
use crate::embree::{self, Config, Device, EmbreeBuilder, EmbreeError, EmbreeScene, Inspection, Width};
use crate::geometry::{Mesh, Tracer};
use rayon::ThreadPool;
use std::sync::OnceLock;
use std::time::Instant;

/// Embree's builders in both widths.
pub fn cells() -> Vec<Cell> {
    let cell = |builder: EmbreeBuilder, width: Width| Cell {
        builder: builder.name().into(),
        width: width.lanes() as u32,
        kernels: if cfg!(feature = "graft") { Kernel::ALL.into() } else { vec![Kernel::EmbreeNative] },
    };
    EmbreeBuilder::ALL.iter().flat_map(|&builder| Width::ALL.map(|width| cell(builder, width))).collect()
}

/// Kernels for our trees.
pub fn kernels_of_ours() -> Vec<Kernel> {
    if cfg!(feature = "graft") { vec![Kernel::EmbreeGrafted, Kernel::Phr] } else { vec![Kernel::Phr] }
}

/// BuildTimes with Embree. In the clock is the commit alone; what it built is asserted from another, verbose
/// one that is not timed.
///
/// # Errors
/// Embree's own words, or a builder that is not the one asked for.
pub fn visit(cell: &Cell, visit: &Visit<'_>, observer: &mut dyn FnMut(Shown<'_>)) -> Result<(), String> {
    let config = config(cell, visit.pools.all.current_num_threads())?;
    let inspection =
        if visit.facts { Some(embree::inspect(visit.mesh, &config).map_err(told)?) } else { None };
    // Devices share threads, as many as the device of most has: that of one must be gone before there are more.
    let mut one_thread = None;
    if visit.pools.one.is_some() {
        let device = Device::new(&Config { threads: 1, ..config }).map_err(told)?;
        let Committed { warm_ms, load, .. } = commits(&device, visit.mesh).map_err(told)?;
        one_thread = Some(OneThreadTimes { warm_ms, load });
    }
    let device = Device::new(&config).map_err(told)?;
    let Committed { cold_ms, warm_ms, load, scene } = commits(&device, visit.mesh).map_err(told)?;
    let peak_bytes = Some(device.memory().peak_bytes as u64);
    let builds = BuildTimes { cold_ms, warm_ms, phases: Vec::new(), peak_bytes, load, one_thread };
    let built = Built { scene: &scene, config, inspection, builds };
    match config.width {
        Width::Four => built.show::<4>(visit, read::four, observer),
        Width::Eight => built.show::<8>(visit, read::eight, observer),
    }
    Ok(())
}

/// The commits of one visit on a device, in the clock.
struct Committed<'a> {
    cold_ms: f64,
    warm_ms: Vec<f64>,
    load: CpuTime,
    /// What the last of them built.
    scene: EmbreeScene<'a>,
}

/// Commits fresh scenes of `mesh`: once with a cold device, then warm.
fn commits<'a>(device: &'a Device, mesh: &'a Mesh) -> Result<Committed<'a>, EmbreeError> {
    let commit = || {
        let prepared = device.prepare(mesh)?;
        device.reset_peak();
        let start = Instant::now();
        let scene = prepared.commit()?;
        Ok::<_, EmbreeError>((start.elapsed(), scene))
    };
    let (cold, first) = commit()?;
    drop(first);
    let mut last = None;
    let (warm_ms, load) = least_disturbed(|| {
        // Two scenes at a time would count as the peak of one.
        last = None;
        let accounts = CpuClock::read();
        let mut warm = Vec::new();
        loop {
            let (duration, scene) = commit()?;
            warm.push(duration);
            if is_enough(&warm) {
                let warm_ms = warm.into_iter().map(ms).collect();
                last = Some(scene);
                return Ok::<_, EmbreeError>((warm_ms, accounts.since()));
            }
        }
    })?;
    let scene = last.expect("there was a commit");
    Ok(Committed { cold_ms: ms(cold), warm_ms, load, scene })
}

/// A tree of Embree's, before it is shown.
struct Built<'a> {
    scene: &'a EmbreeScene<'a>,
    config: Config,
    inspection: Option<Inspection>,
    builds: BuildTimes,
}

impl Built<'_> {
    fn show<const N: usize>(
        self,
        visit: &Visit<'_>,
        read: impl FnOnce(&EmbreeScene<'_>) -> Result<WideBvh<N>, String>,
        observer: &mut dyn FnMut(Shown<'_>),
    ) {
        let others = visit.kernels.iter().any(|&kernel| kernel != Kernel::EmbreeNative);
        let mut tree = if others || visit.facts { read(self.scene) } else { Err("not asked for".into()) };
        let mut facts = None;
        if let Some(inspection) = &self.inspection {
            let statistics =
                tree.as_ref().ok().map(|tree| visit.pools.all.install(|| Statistics::of(tree, visit.mesh)));
            if let Some(found) = statistics.as_ref().filter(|found| !is_same(found.sah, inspection.sah)) {
                let (found, printed) = (found.sah, inspection.sah);
                tree = Err(format!("the tree read has a SAH cost of {found}, Embree printed {printed}"));
            }
            facts = Some(self.facts(inspection, statistics.filter(|_| tree.is_ok())));
        }
        present(visit, tree.as_ref().map_err(Clone::clone), Some(self.scene), self.builds, facts, observer);
    }

    /// Embree's own figures, and those of the tree that was read.
    fn facts(&self, inspection: &Inspection, statistics: Option<Statistics>) -> TreeFacts {
        let printed = TreeFacts {
            engine: format!("embree {}", embree::version()),
            config: self.config.device_string(),
            sah: Some(inspection.sah),
            nodes: Some(inspection.nodes),
            leaves: Some(inspection.leaves),
            depth: Some(inspection.depth),
            leaf_fill: Some(inspection.leaf_fill),
            bytes: Some(inspection.bytes),
            ..TreeFacts::default()
        };
        let Some(statistics) = statistics else { return printed };
        let read = TreeFacts::of(&statistics, printed.engine.clone(), printed.config.clone());
        TreeFacts { sah: printed.sah, bytes: printed.bytes, ..read }
    }
}

/// Embree prints six digits; the tree is of another commit, which may differ in the last of them.
fn is_same(read: f64, printed: f64) -> bool {
    (read - printed).abs() <= 5e-5 * printed.abs()
}

#[cfg(feature = "graft")]
mod read {
    use super::EmbreeScene;
    use crate::bvh::{Bvh4, Bvh8};
    use crate::embree::native;

    /// The 4-wide tree of `scene`, or why it cannot be read.
    pub fn four(scene: &EmbreeScene<'_>) -> Result<Bvh4, String> {
        native::read4(scene).map_err(|unavailable| unavailable.why)
    }

    /// The 8-wide tree of `scene`, or why it cannot be read.
    pub fn eight(scene: &EmbreeScene<'_>) -> Result<Bvh8, String> {
        native::read8(scene).map_err(|unavailable| unavailable.why)
    }
}

#[cfg(not(feature = "graft"))]
mod read {
    use super::{EmbreeScene, WideBvh};

    /// Not without the feature.
    pub fn four(_: &EmbreeScene<'_>) -> Result<WideBvh<4>, String> {
        Err("this program was built without the feature graft".into())
    }

    /// Not without the feature.
    pub fn eight(_: &EmbreeScene<'_>) -> Result<WideBvh<8>, String> {
        Err("this program was built without the feature graft".into())
    }
}

/// Shows `tree` under Embree's kernel, laid out by the one routine for all trees, or says why not. The scene
/// that lends its kernel is built by Morton codes, the quickest.
pub fn with_graft<const N: usize>(
    visit: &Visit<'_>,
    tree: Result<&WideBvh<N>, String>,
    observer: &mut dyn FnMut(Result<&dyn Tracer, String>),
) {
    let shown = tree.and_then(|tree| graft(visit, tree, observer));
    if let Err(why) = shown {
        observer(Err(why));
    }
}

#[cfg(feature = "graft")]
fn graft<const N: usize>(
    visit: &Visit<'_>,
    tree: &WideBvh<N>,
    observer: &mut dyn FnMut(Result<&dyn Tracer, String>),
) -> Result<(), String> {
    let width = if N == 8 { Width::Eight } else { Width::Four };
    let threads = visit.pools.all.current_num_threads();
    let device = Device::new(&Config { builder: EmbreeBuilder::Morton, width, threads }).map_err(told)?;
    let host = device.prepare(visit.mesh).and_then(embree::Prepared::commit).map_err(told)?;
    let graft = embree::graft::Graft::new(host, tree).map_err(|unavailable| unavailable.why)?;
    observer(Ok(&graft));
    Ok(())
}

#[cfg(not(feature = "graft"))]
fn graft<const N: usize>(
    _: &Visit<'_>,
    _: &WideBvh<N>,
    _: &mut dyn FnMut(Result<&dyn Tracer, String>),
) -> Result<(), String> {
    Err("this program was built without the feature graft".into())
}

fn config(cell: &Cell, threads: usize) -> Result<Config, String> {
    let builder = EmbreeBuilder::by_name(&cell.builder)
        .ok_or_else(|| format!("no builder is called {}", cell.builder))?;
    let width = Width::ALL
        .into_iter()
        .find(|width| width.lanes() as u32 == cell.width)
        .ok_or_else(|| format!("Embree has no trees of width {}", cell.width))?;
    Ok(Config { builder, width, threads })
}

fn told(error: EmbreeError) -> String {
    error.to_string()
}

/// The instruction set of Embree's kernels, which it puts before their names, as in
/// `avx2::BVH4Triangle4Intersector1Moeller`.
pub fn isa() -> String {
    static ISA: OnceLock<String> = OnceLock::new();
    let ask = || {
        let (mesh, _) = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).ok()?;
        let config = Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads: 1 };
        let inspection = embree::inspect(&mesh, &config).ok()?;
        inspection.intersector.split_once("::").map(|(isa, _)| isa.to_owned())
    };
    ISA.get_or_init(|| ask().unwrap_or_else(|| "unknown".into())).clone()
}

/// Shows Embree's SAH tree, whose hits are the reference.
///
/// # Errors
/// Embree's own words.
pub fn reference(
    mesh: &Mesh,
    pool: &ThreadPool,
    observer: &mut dyn FnMut(&dyn Tracer),
) -> Result<(), String> {
    let threads = pool.current_num_threads();
    let config = Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads };
    let device = Device::new(&config).map_err(told)?;
    let scene = device.prepare(mesh).and_then(embree::Prepared::commit).map_err(told)?;
    observer(&scene);
    Ok(())
}

/// The library in use.
pub fn library() -> Library {
    Library::of(embree::version())
}
