//! Embree's builders as contenders, and Embree's kernel for any tree.

use super::built_tree::{BuildRequest, BuiltTree, EitherWidth};
use super::repeated::repeated;
use super::scene_tree::{build_instead, is_readable};
pub use super::scene_tree::{graft, read};
use crate::bench::build_times::{BuildTimes, WarmTimes, ms};
use crate::bench::cell::{Cell, Kernel};
use crate::bench::environment::Library;
use crate::bench::tree_facts::TreeFacts;
use crate::bvh::Statistics;
use crate::embree::{
    self, Config, Device, EmbreeBuilder, EmbreeError, EmbreeScene, Inspection, Prepared, Width,
};
use crate::geometry::Mesh;
use rayon::ThreadPool;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// The kernel that traces the reference tree.
pub const REFERENCE_KERNEL: Kernel = Kernel::EmbreeNative;

/// Embree's builders in both widths.
pub fn cells() -> Vec<Cell> {
    let without_graft = &[Kernel::EmbreeNative, Kernel::Phr];
    let kernels: &[Kernel] = if cfg!(feature = "graft") { &Kernel::ALL } else { without_graft };
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
    /// Whether trees are read where they can be; not in a test of what is built instead.
    reads: bool,
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
        Ok(Self { builder, width, reads: true })
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
            let tree = self.tree_for(request, &scene);
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

        let mut tree = self.tree_for(request, &scene);
        let is_own = self.is_own(&scene);
        let mut facts = None;
        if let Some(printed) = &inspection {
            let statistics = tree.as_ref().ok().map(|tree| pools.all.install(|| statistics(tree, mesh)));
            let is_right = if is_own { is_same } else { is_near };
            if let Some(found) = statistics.as_ref().filter(|found| !is_right(found.sah, printed.sah)) {
                let (found, printed) = (found.sah, printed.sah);
                tree = Err(format!("the tree found has a SAH cost of {found}, Embree printed {printed}"));
            }
            if let Some(rebuilt) = [same, dynamic].into_iter().flatten().find(|&it| !is_same(it, printed.sah))
            {
                let printed = printed.sah;
                return Err(format!("a tree built again has a SAH cost of {rebuilt}, a fresh one {printed}"));
            }
            facts = Some(facts_of(printed, &config, statistics.filter(|_| tree.is_ok()), is_own));
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

    /// The tree of `scene` in our form, or one built instead, where the request needs it.
    fn tree_for(&self, request: &BuildRequest<'_>, scene: &EmbreeScene<'_>) -> Result<EitherWidth, String> {
        let is_needed = request.wants_facts || request.kernels.iter().any(|&it| it != Kernel::EmbreeNative);
        match is_needed {
            true if self.is_own(scene) => read(scene, self.width),
            true => build_instead(scene, self.builder, self.width),
            false => Err("not asked for".into()),
        }
    }

    /// Whether trees in our form are the scenes' own.
    fn is_own(&self, scene: &EmbreeScene<'_>) -> bool {
        self.reads && is_readable(scene.device())
    }

    /// The SAH cost of a scene's own tree, where it is asked for and the tree can be read.
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

/// Embree's printed figures, and those of the tree in our form: all others where it is the scene's own, else what
/// Embree does not print, and a word on it.
fn facts_of(
    inspection: &Inspection,
    config: &Config,
    statistics: Option<Statistics>,
    is_own: bool,
) -> TreeFacts {
    let printed = TreeFacts {
        engine: format!("embree {}", embree::version()),
        config: config.device_string(),
        sah: Some(inspection.sah).filter(|sah| !sah.is_nan()),
        nodes: Some(inspection.nodes),
        leaves: Some(inspection.leaves),
        depth: Some(inspection.depth),
        leaf_fill: Some(inspection.leaf_fill),
        bytes: Some(inspection.bytes),
        ..TreeFacts::default()
    };
    let Some(statistics) = statistics else { return printed };
    let found = TreeFacts::of(&statistics, printed.engine.clone(), printed.config.clone());
    let printed = TreeFacts { sah: printed.sah.or(found.sah), ..printed };
    if is_own {
        return TreeFacts { sah: printed.sah, bytes: printed.bytes, ..found };
    }
    let engine = format!("{} (tree: rtcBuildBVH)", printed.engine);
    TreeFacts { engine, epo: found.epo, refs_per_tri: found.refs_per_tri, ..printed }
}

/// Embree prints six digits, of another commit's tree, and no number of a scene without area.
fn is_same(read: f64, printed: f64) -> bool {
    printed.is_nan() || (read - printed).abs() <= 5e-5 * printed.abs()
}

/// A tree built instead may cost more, where the scene's has rotations: 4-wide by Morton codes 1.01 to 1.17 times as
/// much in the meshes tried.
fn is_near(built: f64, printed: f64) -> bool {
    printed.is_nan() || (built - printed).abs() <= 0.5 * printed.abs()
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
    Embree { builder: EmbreeBuilder::Sah, width: Width::Four, reads: true }.once(mesh, pool)
}

/// The library in use.
pub fn library() -> Library {
    Library::of(embree::version())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::contender::TreeUnderKernel;
    use crate::bench::pools::Pools;
    use crate::bench::settings::Settings;
    use crate::random::SplitMix64;

    #[test]
    fn a_tree_built_instead_says_so_and_is_traced() {
        let mut random = SplitMix64::new(3);
        let vertices = (0..6000).map(|i| (random.point(-1.0, 1.0) + (i / 3 % 17) as f32).to_array());
        let triangles = (0..2000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = Mesh::new(vertices.collect(), triangles).unwrap().0;
        let pools = Pools::new(&Settings::new(16, 1, 1, 2)).unwrap();
        let kernels = &[Kernel::Phr];
        let request =
            BuildRequest { mesh: &mesh, pools: &pools, kernels, wants_facts: true, fresh_only: false };
        for (builder, width) in EmbreeBuilder::ALL.into_iter().zip([Width::Four, Width::Eight, Width::Four]) {
            let build = |reads| Embree { builder, width, reads }.build(&request).unwrap();
            let (own, instead) = (build(true), build(false));
            let [own, facts] = [&own, &instead].map(|built| built.facts.clone().unwrap());
            assert!(facts.engine.ends_with(" (tree: rtcBuildBVH)"), "{facts:?}");
            assert!(facts.epo.is_some() && facts.refs_per_tri >= Some(1.0), "{facts:?}");
            // What Embree prints is of its own tree either way.
            assert!(is_same(facts.sah.unwrap(), own.sah.unwrap()), "{facts:?} {own:?}");
            assert!(TreeUnderKernel::new(&instead, Kernel::Phr, 2).unwrap().tracer().is_ok());
        }
    }
}
