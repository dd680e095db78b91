//! The driver's view of Embree where this program was built without it.

use crate::bench::cell::{Cell, Kernel};
use crate::bench::contender::{Shown, Visit};
use crate::bench::environment::Library;
use crate::builders;
use crate::bvh::WideBvh;
use crate::geometry::{Mesh, Tracer};
use crate::trace::BvhTracer;
use rayon::ThreadPool;

const ABSENT: &str = "this program was built without Embree";

/// No builders.
pub fn cells() -> Vec<Cell> {
    Vec::new()
}

/// Our kernel alone.
pub fn kernels_of_ours() -> Vec<Kernel> {
    vec![Kernel::Phr]
}

/// There is no such builder.
///
/// # Errors
/// Always.
pub fn visit(cell: &Cell, _: &Visit<'_>, _: &mut dyn FnMut(Shown<'_>)) -> Result<(), String> {
    Err(format!("no builder is called {}; {ABSENT}", cell.builder))
}

/// There is no kernel to graft to.
pub fn with_graft<const N: usize>(
    _: &Visit<'_>,
    _: Result<&WideBvh<N>, String>,
    observer: &mut dyn FnMut(Result<&dyn Tracer, String>),
) {
    observer(Err(ABSENT.into()));
}

/// Shows a tree of our last builder, whose hits are the reference.
///
/// # Errors
/// No builder at all.
pub fn reference(
    mesh: &Mesh,
    pool: &ThreadPool,
    observer: &mut dyn FnMut(&dyn Tracer),
) -> Result<(), String> {
    let builder = builders::NAMES.last().and_then(|name| builders::by_name(name));
    let mut builder = builder.ok_or("this program has no builders")?;
    let built = pool.install(|| builder.build(mesh));
    observer(&BvhTracer::new(&built.tree));
    Ok(())
}

/// No instruction set.
pub fn isa() -> String {
    String::new()
}

/// No library.
pub fn library() -> Library {
    Library { note: ABSENT.into(), ..Library::default() }
}
