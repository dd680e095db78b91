//! The contenders: our builders, and Embree's where this program was built with Embree. A [`Contender`] builds
//! and returns a [`BuiltTree`]; put under kernels ([`TreeUnderKernel`]), it is traced.

mod built_tree;
mod caught;
#[cfg(feature = "embree")]
mod embree;
mod ours;
pub mod pools;
mod repeated;
mod tree_under_kernel;
mod variant;
#[cfg(not(feature = "embree"))]
mod without_embree;

pub use built_tree::{BuildRequest, BuiltTree, EitherWidth};
#[cfg(feature = "graft")]
pub use embree::isas as embree_isas;
#[cfg(feature = "embree")]
pub use embree::{Embree, REFERENCE_KERNEL, library, reference};
pub use ours::Ours;
pub use tree_under_kernel::TreeUnderKernel;
pub use variant::{Configuration, Variant};
#[cfg(not(feature = "embree"))]
pub use without_embree::{Embree, REFERENCE_KERNEL, library, reference};

use super::cell::{Cell, place};
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
}

impl Contender {
    /// The builder of `cell`.
    ///
    /// # Errors
    /// No such builder, in one line.
    pub fn of(cell: &Cell) -> Result<Self, String> {
        let name = &cell.builder;
        let ours = match cell.width {
            4 => Ours::by_name(name).map(Self::Four),
            8 => Ours::by_name(name).map(Self::Eight),
            _ => None,
        };
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
        }
    }
}

/// All cells of this program, in the table's order.
pub fn cells(build_only: bool) -> Vec<Cell> {
    let mut cells: Vec<Cell> = ours::cells(&embree::kernels_of_ours()).chain(embree::cells()).collect();
    cells.sort_by_key(|cell| (place(&cell.builder), cell.width));
    if build_only {
        cells.iter_mut().for_each(|cell| cell.kernels.clear());
    }
    cells
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
