//! In place of Embree where this program was built without it: no builders, and our last builder as the
//! reference.

use super::built_tree::{BuildRequest, BuiltTree};
use super::ours::Ours;
use crate::bench::cell::{Cell, Kernel};
use crate::bench::environment::Library;
use crate::builders;
use crate::bvh::WideBvh;
use crate::geometry::{Mesh, Tracer};
use rayon::ThreadPool;

const ABSENT: &str = "this program was built without Embree";

/// The kernel that traces the reference tree.
pub const REFERENCE_KERNEL: Kernel = Kernel::Phr;

/// No builder of Embree's.
pub enum Embree {}

impl Embree {
    /// There is no such builder.
    ///
    /// # Errors
    /// Always.
    pub fn new(cell: &Cell) -> Result<Self, String> {
        Err(format!("no builder is called {}; {ABSENT}", cell.builder))
    }

    /// Never called.
    ///
    /// # Errors
    /// None.
    pub fn build<'a>(&mut self, _: &BuildRequest<'a>) -> Result<BuiltTree<'a>, String> {
        match *self {}
    }

    /// Never called.
    ///
    /// # Errors
    /// None.
    pub fn once<'a>(&self, _: &'a Mesh, _: &ThreadPool) -> Result<BuiltTree<'a>, String> {
        match *self {}
    }
}

/// No cells.
pub fn cells() -> Vec<Cell> {
    Vec::new()
}

/// Our kernel alone.
pub fn kernels_of_ours() -> Vec<Kernel> {
    vec![Kernel::Phr]
}

/// There is no kernel of Embree's to graft the tree to.
///
/// # Errors
/// Always.
pub fn graft<'a, const N: usize>(
    _: &'a Mesh,
    _: &WideBvh<N>,
    _: usize,
) -> Result<Box<dyn Tracer + 'a>, String> {
    Err(ABSENT.into())
}

/// Builds the tree whose hits are the reference, with our last builder.
///
/// # Errors
/// A builder that panicked, in one line.
pub fn reference<'a>(mesh: &'a Mesh, pool: &ThreadPool) -> Result<BuiltTree<'a>, String> {
    let builder = builders::NAMES.last().and_then(|name| Ours::<4>::by_name(name));
    builder.ok_or("this program has no builders")?.once(mesh, pool)
}

/// No instruction sets.
pub fn isas() -> [String; 2] {
    Default::default()
}

/// No library.
pub fn library() -> Library {
    Library { note: ABSENT.into(), ..Library::default() }
}
