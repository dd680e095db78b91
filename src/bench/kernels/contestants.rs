//! The trees of a scene, and all that traces them.

use super::row::{PORTABLE, WATERTIGHT};
#[cfg(feature = "graft")]
use super::row::{ROBUST, SINGLE};
use crate::bench::cell::Cell;
use crate::bench::contender::{self, EitherWidth};
use crate::builders;
use crate::bvh::WideBvh;
#[cfg(feature = "graft")]
use crate::embree::{Config, Device, EmbreeBuilder, EmbreeScene, Width, native};
use crate::geometry::{Mesh, Tracer};
use crate::simd::Isa;
use crate::trace::{BatchTracer, BvhTracer, WatertightTracer, kernel_isa};
use rayon::ThreadPool;

/// The trees of a scene.
pub struct Trees<'a>(Vec<Tree<'a>>);

/// One of them.
struct Tree<'a> {
    cell: Cell,
    mesh: &'a Mesh,
    tree: EitherWidth,
    /// Whether all kernels trace it, or those of single rays alone.
    by_all: bool,
    #[cfg(feature = "graft")]
    scenes: Option<Scenes<'a>>,
}

/// Embree's scenes of a tree.
#[cfg(feature = "graft")]
struct Scenes<'a> {
    fast: EmbreeScene<'a>,
    /// That of the SAH builder with watertight kernels, which want other leaves.
    robust: Option<EmbreeScene<'a>>,
}

/// A kernel over one of the trees.
pub struct Contestant<'t> {
    /// Who built the tree.
    pub builder: &'t str,
    /// Children per node.
    pub width: u32,
    /// The kernel's name.
    pub kernel: &'static str,
    /// Its instruction set.
    pub isa: String,
    /// The kernel.
    pub tracer: Box<dyn Tracer + 't>,
}

impl<'a> Trees<'a> {
    /// Builds the trees of `cells` over `mesh`. All kernels trace those of the first builder, single rays the others.
    ///
    /// # Errors
    /// What a builder cannot do, in one line.
    pub fn build(mesh: &'a Mesh, cells: &[Cell], pool: &ThreadPool) -> Result<Self, String> {
        let by_all = |cell: &Cell| cells.first().is_some_and(|first| first.builder == cell.builder);
        cells
            .iter()
            .map(|cell| Tree::build(mesh, cell, by_all(cell), pool))
            .collect::<Result<_, _>>()
            .map(Self)
    }

    /// All kernels over all trees, the first of them the reference.
    pub fn contestants(&self) -> Vec<Contestant<'_>> {
        let of_embree = self.0.iter().flat_map(Tree::of_embree);
        let ours = self.0.iter().flat_map(|tree| match &tree.tree {
            EitherWidth::Four(bvh) => tree.ours(bvh),
            EitherWidth::Eight(bvh) => tree.ours(bvh),
        });
        of_embree.chain(ours).collect()
    }
}

impl<'a> Tree<'a> {
    fn build(mesh: &'a Mesh, cell: &Cell, by_all: bool, pool: &ThreadPool) -> Result<Self, String> {
        let ours = match cell.width {
            8 => built::<8>(mesh, cell.made_by(), pool).map(EitherWidth::Eight),
            _ => built::<4>(mesh, cell.made_by(), pool).map(EitherWidth::Four),
        };
        if let Some(tree) = ours {
            return Ok(Self {
                cell: cell.clone(),
                mesh,
                tree,
                by_all,
                #[cfg(feature = "graft")]
                scenes: None,
            });
        }
        #[cfg(feature = "graft")]
        if let Some(builder) = EmbreeBuilder::by_name(&cell.builder) {
            let width = if cell.width == 8 { Width::Eight } else { Width::Four };
            let config = Config { builder, width, threads: pool.current_num_threads() };
            let fast = || Device::new(&config)?.prepare(mesh)?.commit();
            let fast = fast().map_err(|error| error.to_string())?;
            let tree = match width {
                Width::Four => native::read4(&fast).map(EitherWidth::Four),
                Width::Eight => native::read8(&fast).map(EitherWidth::Eight),
            };
            let tree = tree.map_err(|unavailable| unavailable.why)?;
            let robust = || Device::robust(&config)?.prepare(mesh)?.robust().commit();
            let robust = (by_all && builder == EmbreeBuilder::Sah)
                .then(robust)
                .transpose()
                .map_err(|error| error.to_string())?;
            let scenes = Some(Scenes { fast, robust });
            return Ok(Self { cell: cell.clone(), mesh, tree, by_all, scenes });
        }
        Err(format!("no builder is called {}", cell.builder))
    }

    fn contestant<'t>(
        &'t self,
        kernel: &'static str,
        isa: &str,
        tracer: Box<dyn Tracer + 't>,
    ) -> Contestant<'t> {
        Contestant { builder: &self.cell.builder, width: self.cell.width, kernel, isa: isa.into(), tracer }
    }

    /// Embree's kernels, over trees that Embree built.
    #[cfg(feature = "graft")]
    fn of_embree(&self) -> Vec<Contestant<'_>> {
        /// The kernel of that name, where this Embree has it.
        fn some<'t>(
            name: &'static str,
            tracer: Option<impl Tracer + 't>,
        ) -> Option<(&'static str, Box<dyn Tracer + 't>)> {
            Some((name, Box::new(tracer?)))
        }
        let Some(Scenes { fast: scene, robust }) = &self.scenes else { return Vec::new() };
        let [isa, _] = contender::embree_isas();
        let single: (&str, Box<dyn Tracer>) = (SINGLE, Box::new(Borrowed(scene)));
        if !self.by_all {
            return vec![self.contestant(SINGLE, &isa, single.1)];
        }
        let grouped = [
            some("embree-packets-8", scene.packets::<8>(false)),
            some("embree-packets-8-coherent", scene.packets::<8>(true)),
            some("embree-packets-16", scene.packets::<16>(false)),
            some("embree-packets-16-coherent", scene.packets::<16>(true)),
            #[cfg(not(embree4))]
            some("embree-stream", scene.stream(false)),
            #[cfg(not(embree4))]
            some("embree-stream-coherent", scene.stream(true)),
            #[cfg(not(embree4))]
            some("embree-packet-stream", scene.packet_stream(false)),
            #[cfg(not(embree4))]
            some("embree-packet-stream-coherent", scene.packet_stream(true)),
            some(ROBUST, robust.as_ref().map(Borrowed)),
        ];
        let all = [single].into_iter().chain(grouped.into_iter().flatten());
        all.map(|(name, tracer)| self.contestant(name, &isa, tracer)).collect()
    }

    #[cfg(not(feature = "graft"))]
    fn of_embree(&self) -> Vec<Contestant<'_>> {
        Vec::new()
    }

    /// Our kernels.
    fn ours<'t, const N: usize>(&'t self, tree: &'t WideBvh<N>) -> Vec<Contestant<'t>> {
        let single = self.contestant("phr", kernel_isa().name(), Box::new(BvhTracer::new(tree)));
        if !self.by_all {
            return vec![single];
        }
        let batch = BatchTracer::new(tree);
        let watertight = WatertightTracer::new(tree, self.mesh);
        let portable = BvhTracer::with_isa(tree, Isa::Scalar);
        vec![
            single,
            self.contestant("phr-batch", batch.isa().name(), Box::new(batch)),
            self.contestant(WATERTIGHT, watertight.isa().name(), Box::new(watertight)),
            self.contestant(PORTABLE, Isa::Scalar.name(), Box::new(portable)),
        ]
    }
}

/// Kernels of Embree's that the one in use lacks, in a line.
pub fn left_out() -> Option<String> {
    let why = || {
        format!("embree-stream, embree-packet-stream: Embree {} has no streams", contender::library().embree)
    };
    cfg!(embree4).then(why)
}

/// The tree of our builder called `name`.
fn built<const N: usize>(mesh: &Mesh, name: &str, pool: &ThreadPool) -> Option<WideBvh<N>> {
    let mut builder = builders::by_name::<N>(name)?;
    Some(pool.install(|| builder.build(mesh)).tree)
}

/// A tracer that someone else keeps.
#[cfg(feature = "graft")]
struct Borrowed<'t, 'a>(&'t EmbreeScene<'a>);

#[cfg(feature = "graft")]
impl Tracer for Borrowed<'_, '_> {
    fn closest(&self, rays: &[crate::geometry::Ray], hits: &mut [crate::geometry::Hit]) {
        self.0.closest(rays, hits);
    }

    fn any(&self, rays: &[crate::geometry::Ray], occluded: &mut [bool]) {
        self.0.any(rays, occluded);
    }
}
