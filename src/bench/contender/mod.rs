//! The contenders: our builders, Embree's where this program was built with Embree, and those of other crates with the
//! feature `peers`. A [`Contender`] builds
//! and returns a [`BuiltTree`]; put under kernels ([`TreeUnderKernel`]), it is traced.

mod built_tree;
mod caught;
#[cfg(feature = "embree")]
mod embree;
mod ours;
#[cfg(feature = "peers")]
mod peers;
pub mod pools;
mod repeated;
pub mod saved;
#[cfg(feature = "embree")]
mod scene_tree;
mod tree_under_kernel;
#[cfg(not(feature = "embree"))]
mod without_embree;

pub use built_tree::{BuildRequest, BuiltTree, EitherWidth, Saving};
pub use caught::caught;
#[cfg(feature = "graft")]
pub use embree::isas as embree_isas;
#[cfg(feature = "embree")]
pub use embree::{Embree, REFERENCE_KERNEL, library, read as embree_tree, reference};
pub use ours::Ours;
pub use tree_under_kernel::TreeUnderKernel;
#[cfg(not(feature = "embree"))]
pub use without_embree::{Embree, REFERENCE_KERNEL, library, reference};

use super::cell::{Cell, Kernel, place};
use crate::builders::Recipe;
use crate::geometry::Mesh;
use crate::simd::Isa;
use crate::trace;
use rayon::ThreadPool;
#[cfg(not(feature = "embree"))]
use without_embree as embree;

/// A builder under measurement.
pub enum Contender {
    /// One of our builders, of 4-wide trees.
    Four(Ours<4>),
    /// One of our builders, of 8-wide trees.
    Eight(Ours<8>),
    /// One of Embree's builders.
    Embree(Embree),
    /// A builder of another crate.
    #[cfg(feature = "peers")]
    Peer(Box<dyn peers::Contestant>),
}

impl Contender {
    /// The builder of `cell`.
    ///
    /// # Errors
    /// No such builder, in one line.
    pub fn of(cell: &Cell) -> Result<Self, String> {
        let name = cell.made_by();
        let ours = match cell.width {
            4 => Ours::by_name(name).or_else(|| saved::by_name(name)).map(Self::Four),
            8 => Ours::by_name(name).or_else(|| saved::by_name(name)).map(Self::Eight),
            _ => None,
        };
        #[cfg(feature = "peers")]
        let ours = ours.or_else(|| peers::of(cell).map(Self::Peer));
        ours.map_or_else(|| Embree::new(cell).map(Self::Embree), Ok)
    }

    /// Builds the tree in each regime.
    ///
    /// # Errors
    /// A builder that panicked, failed or was not the one asked for, in one line. The contender is then of no
    /// further use.
    pub fn build<'a>(&mut self, request: &BuildRequest<'a>) -> Result<BuiltTree<'a>, String> {
        match self {
            Self::Four(ours) => ours.build(request),
            Self::Eight(ours) => ours.build(request),
            Self::Embree(embree) => embree.build(request),
            #[cfg(feature = "peers")]
            Self::Peer(peer) => peer.build(request),
        }
    }

    /// Builds the tree once, untimed, and keeps nothing else.
    ///
    /// # Errors
    /// As [`Contender::build`].
    pub fn once<'a>(&self, mesh: &'a Mesh, pool: &ThreadPool) -> Result<BuiltTree<'a>, String> {
        match self {
            Self::Four(ours) => ours.once(mesh, pool),
            Self::Eight(ours) => ours.once(mesh, pool),
            Self::Embree(embree) => embree.once(mesh, pool),
            #[cfg(feature = "peers")]
            Self::Peer(peer) => peer.once(mesh, pool),
        }
    }
}

/// All cells of this program, in the table's order.
pub fn cells(build_only: bool) -> Vec<Cell> {
    let kernels = embree::kernels_of_ours();
    let mut cells: Vec<Cell> =
        ours::cells(&kernels).chain(saved::cells(&kernels)).chain(embree::cells()).collect();
    #[cfg(feature = "peers")]
    cells.extend(peers::cells(&kernels));
    cells.sort_by_key(|cell| (place(&cell.builder), cell.width));
    if build_only {
        cells.iter_mut().for_each(|cell| cell.kernels.clear());
    }
    cells
}

/// The cells of a builder of ours made by `recipe`, called `name`, in both widths.
pub fn cells_of(name: &str, recipe: &Recipe, build_only: bool) -> [Cell; 2] {
    let kernels = if build_only { Vec::new() } else { embree::kernels_of_ours() };
    let made_by = recipe.name();
    let recipe = (name != made_by).then_some(made_by);
    [4, 8].map(|width| Cell { recipe: recipe.clone(), ..Cell::new(name, width, &kernels) })
}

/// The kernels that trace our trees here, the fairest first.
pub fn kernels_of_ours() -> Vec<Kernel> {
    embree::kernels_of_ours()
}

/// The instruction sets in use, for the records: of kernels and builders, ours and Embree's (null without it).
pub fn isa() -> serde_json::Value {
    let [kernel, builders] = embree::isas().map(|name| Some(name).filter(|name| !name.is_empty()));
    serde_json::json!({
        "phr": trace::kernel_isa().name(),
        "phr_builders": Isa::best().name(),
        "embree": kernel,
        "embree_builders": builders,
    })
}
