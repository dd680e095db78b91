//! Embree's builders as contenders, and Embree's kernel for any tree.

use super::built_tree::{BuildRequest, BuiltTree, EitherWidth};
use super::repeated::repeated;
use crate::bench::build_times::{BuildTimes, WarmTimes, ms};
use crate::bench::cell::{Cell, Kernel};
use crate::bench::environment::Library;
use crate::bench::tree_facts::TreeFacts;
use crate::bvh::{Statistics, WideBvh};
use crate::embree::{
    self, Config, Device, EmbreeBuilder, EmbreeError, EmbreeScene, Inspection, Prepared, Width,
};
use crate::geometry::{Mesh, Tracer};
use rayon::ThreadPool;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

#[cfg(not(feature = "graft"))]
const NO_GRAFT: &str = "this program was built without the feature graft";

/// The kernel that traces the reference tree.
pub const REFERENCE_KERNEL: Kernel = Kernel::EmbreeNative;

/// Embree's builders in both widths.
pub fn cells() -> Vec<Cell> {
    let kernels: &[Kernel] = if cfg!(feature = "graft") { &Kernel::ALL } else { &[Kernel::EmbreeNative] };
    let cell =
        |builder: EmbreeBuilder, width: Width| Cell::new(builder.name(), width.lanes() as u32, kernels);
    EmbreeBuilder::ALL.iter().flat_map(|&builder| Width::ALL.map(|width| cell(builder, width))).collect()
}

/// Kernels for our trees.
pub fn kernels_of_ours() -> Vec<Kernel> {
    if cfg!(feature = "graft") { vec![Kernel::EmbreeGrafted, Kernel::Phr] } else { vec![Kernel::Phr] }
}

/// One of Embree's builders. The clock holds the commit alone.
pub struct Embree {
    builder: EmbreeBuilder,
    width: Width,
}

impl Embree {
    /// The builder of `cell`.
    ///
    /// # Errors
    /// No builder of that name, or none of that width.
    pub fn new(cell: &Cell) -> Result<Self, String> {
        let builder = EmbreeBuilder::by_name(&cell.builder)
            .ok_or_else(|| format!("no builder is called {}", cell.builder))?;
        let width = Width::ALL
            .into_iter()
            .find(|width| width.lanes() as u32 == cell.width)
            .ok_or_else(|| format!("Embree has no trees of width {}", cell.width))?;
        Ok(Self { builder, width })
    }

    /// Builds in each regime, on one thread too where the request has a pool of one. Where facts are wanted, another
    /// verbose commit, untimed, asserts which builder ran.
    ///
    /// # Errors
    /// Embree's message, or a builder that is not the one asked for.
    pub fn build<'a>(&mut self, request: &BuildRequest<'a>) -> Result<BuiltTree<'a>, String> {
        let BuildRequest { mesh, pools, .. } = *request;
        let config = self.config(pools.all.current_num_threads());
        if request.fresh_only {
            let device = Device::new(&config).map_err(message)?;
            let (fresh, scene) = fresh(&device, mesh).map_err(message)?;
            let times = BuildTimes { fresh, ..BuildTimes::default() };
            let tree = self.read_for(request, &scene);
            return Ok(BuiltTree { times, facts: None, mesh, tree, native: Some(Box::new(scene)) });
        }
        let inspection = match request.wants_facts {
            true => Some(embree::inspect(mesh, &config).map_err(message)?),
            false => None,
        };
        // Devices share threads, as many as the largest of them has: the device of one thread must be gone before
        // that of all is made.
        let mut one_thread = None;
        if pools.one.is_some() {
            let device = Device::new(&self.config(1)).map_err(message)?;
            commit(device.prepare(mesh).map_err(message)?).map_err(message)?;
            one_thread = Some(fresh(&device, mesh).map_err(message)?.0);
        }
        let device = Device::new(&config).map_err(message)?;
        let (first, scene) = device.prepare(mesh).and_then(commit).map_err(message)?;
        let (rebuild, scene) = again(scene).map_err(message)?;
        let same = self.cost(&scene, request.wants_facts);
        drop(scene);
        let scene = device.prepare(mesh).map(Prepared::dynamic).and_then(Prepared::commit);
        let (dynamic_rebuild, scene) = scene.and_then(again).map_err(message)?;
        let dynamic = self.cost(&scene, request.wants_facts);
        drop(scene);
        let (fresh, scene) = fresh(&device, mesh).map_err(message)?;
        let times = BuildTimes {
            first_ms: ms(first),
            fresh,
            rebuild,
            dynamic_rebuild: Some(dynamic_rebuild),
            phases: Vec::new(),
            one_thread,
        };

        let mut tree = self.read_for(request, &scene);
        let mut facts = None;
        if let Some(printed) = &inspection {
            let statistics = tree.as_ref().ok().map(|tree| pools.all.install(|| statistics(tree, mesh)));
            if let Some(read) = statistics.as_ref().filter(|read| !is_same(read.sah, printed.sah)) {
                let (read, printed) = (read.sah, printed.sah);
                tree = Err(format!("the tree read has a SAH cost of {read}, Embree printed {printed}"));
            }
            if let Some(rebuilt) = [same, dynamic].into_iter().flatten().find(|&it| !is_same(it, printed.sah))
            {
                let printed = printed.sah;
                return Err(format!("a tree built again has a SAH cost of {rebuilt}, a fresh one {printed}"));
            }
            facts = Some(facts_of(printed, &config, statistics.filter(|_| tree.is_ok())));
        }
        Ok(BuiltTree { times, facts, mesh, tree, native: Some(Box::new(scene)) })
    }

    /// Builds once, untimed; the tree is not read.
    ///
    /// # Errors
    /// Embree's message.
    pub fn once<'a>(&self, mesh: &'a Mesh, pool: &ThreadPool) -> Result<BuiltTree<'a>, String> {
        let device = Device::new(&self.config(pool.current_num_threads())).map_err(message)?;
        let scene = device.prepare(mesh).and_then(Prepared::commit).map_err(message)?;
        let tree = Err("it was not read".into());
        Ok(BuiltTree { times: BuildTimes::default(), facts: None, mesh, tree, native: Some(Box::new(scene)) })
    }

    /// The tree of `scene` in our form, where the request needs it.
    fn read_for(&self, request: &BuildRequest<'_>, scene: &EmbreeScene<'_>) -> Result<EitherWidth, String> {
        let is_read = request.wants_facts || request.kernels.iter().any(|&it| it != Kernel::EmbreeNative);
        if is_read { read(scene, self.width) } else { Err("not asked for".into()) }
    }

    /// The SAH cost of a scene's tree, where it is asked for and the tree can be read.
    fn cost(&self, scene: &EmbreeScene<'_>, is_asked_for: bool) -> Option<f64> {
        is_asked_for.then(|| read(scene, self.width).ok()).flatten().map(|tree| tree.sah_cost())
    }

    fn config(&self, threads: usize) -> Config {
        Config { builder: self.builder, width: self.width, threads }
    }
}

/// Builds the tree of `prepared`.
fn commit(prepared: Prepared<'_>) -> Result<(Duration, EmbreeScene<'_>), EmbreeError> {
    let start = Instant::now();
    let scene = prepared.commit()?;
    Ok((start.elapsed(), scene))
}

/// Commits new scenes of `mesh`, each after the one before is gone; returns the last of them.
fn fresh<'a>(device: &Device, mesh: &'a Mesh) -> Result<(WarmTimes, EmbreeScene<'a>), EmbreeError> {
    let mut last = None;
    let times = repeated(|| {
        last = None;
        let (duration, scene) = commit(device.prepare(mesh)?)?;
        last = Some(scene);
        Ok::<_, EmbreeError>(duration)
    })?;
    Ok((times, last.expect("there was a commit")))
}

/// Commits `scene` again.
fn again(scene: EmbreeScene<'_>) -> Result<(WarmTimes, EmbreeScene<'_>), EmbreeError> {
    let mut last = Some(scene);
    let times = repeated(|| {
        let scene = last.take().expect("the scene of the commit before");
        let (duration, scene) = commit(scene.modified()?)?;
        last = Some(scene);
        Ok::<_, EmbreeError>(duration)
    })?;
    Ok((times, last.expect("there was a commit")))
}

fn statistics(tree: &EitherWidth, mesh: &Mesh) -> Statistics {
    match tree {
        EitherWidth::Four(tree) => Statistics::of(tree, mesh),
        EitherWidth::Eight(tree) => Statistics::of(tree, mesh),
    }
}

/// Embree's printed figures, and those of the tree that was read.
fn facts_of(inspection: &Inspection, config: &Config, statistics: Option<Statistics>) -> TreeFacts {
    let printed = TreeFacts {
        engine: format!("embree {}", embree::version()),
        config: config.device_string(),
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

/// Embree prints six digits; the tree is of another commit, which may differ in the last of them.
fn is_same(read: f64, printed: f64) -> bool {
    (read - printed).abs() <= 5e-5 * printed.abs()
}

/// The tree of `scene` in our form, or why it cannot be read.
///
/// # Errors
/// Why not.
#[cfg(feature = "graft")]
pub fn read(scene: &EmbreeScene<'_>, width: Width) -> Result<EitherWidth, String> {
    use crate::embree::native;
    let tree = match width {
        Width::Four => native::read4(scene).map(EitherWidth::Four),
        Width::Eight => native::read8(scene).map(EitherWidth::Eight),
    };
    tree.map_err(|unavailable| unavailable.why)
}

/// Not without the feature.
///
/// # Errors
/// Always.
#[cfg(not(feature = "graft"))]
pub fn read(_: &EmbreeScene<'_>, _: Width) -> Result<EitherWidth, String> {
    Err(NO_GRAFT.into())
}

/// Puts `tree` under Embree's kernel, laid out by the one routine for all trees. The scene whose root it
/// replaces is built by Morton codes, the quickest.
///
/// # Errors
/// Why that cannot be done here.
#[cfg(feature = "graft")]
pub fn graft<'a, const N: usize>(
    mesh: &'a Mesh,
    tree: &WideBvh<N>,
    threads: usize,
) -> Result<Box<dyn Tracer + 'a>, String> {
    let width = if N == 8 { Width::Eight } else { Width::Four };
    let device = Device::new(&Config { builder: EmbreeBuilder::Morton, width, threads }).map_err(message)?;
    let host = device.prepare(mesh).and_then(embree::Prepared::commit).map_err(message)?;
    let graft = embree::graft::Graft::new(host, tree).map_err(|unavailable| unavailable.why)?;
    Ok(Box::new(graft))
}

/// Not without the feature.
///
/// # Errors
/// Always.
#[cfg(not(feature = "graft"))]
pub fn graft<'a, const N: usize>(
    _: &'a Mesh,
    _: &WideBvh<N>,
    _: usize,
) -> Result<Box<dyn Tracer + 'a>, String> {
    Err(NO_GRAFT.into())
}

fn message(error: EmbreeError) -> String {
    error.to_string()
}

/// The instruction sets of Embree's kernels and builders, which it puts before their names, as in
/// `avx2::BVH4Triangle4Intersector1Moeller` and `avx::BVH4BuilderSAH`.
pub fn isas() -> [String; 2] {
    static ISAS: OnceLock<[String; 2]> = OnceLock::new();
    let ask = || {
        let (mesh, _) = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).ok()?;
        let config = Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads: 1 };
        let inspection = embree::inspect(&mesh, &config).ok()?;
        let isa = |name: String| name.split_once("::").map_or("unknown".into(), |(isa, _)| isa.to_owned());
        Some([inspection.intersector, inspection.builder].map(isa))
    };
    ISAS.get_or_init(|| ask().unwrap_or_else(|| ["unknown", "unknown"].map(Into::into))).clone()
}

/// Builds Embree's SAH tree, whose hits are the reference.
///
/// # Errors
/// Embree's message.
pub fn reference<'a>(mesh: &'a Mesh, pool: &ThreadPool) -> Result<BuiltTree<'a>, String> {
    Embree { builder: EmbreeBuilder::Sah, width: Width::Four }.once(mesh, pool)
}

/// The library in use.
pub fn library() -> Library {
    Library::of(embree::version())
}
