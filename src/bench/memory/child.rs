//! In the process that builds once.

use super::BuildMemory;
use super::mesh_stream;
use crate::bench::cell::Cell;
use crate::bench::contender::Contender;
use crate::geometry::Mesh;
use crate::memory::resident;
use rayon::ThreadPool;
use std::io::Read;

/// Triangles of the build before the measured one.
const FEW: usize = 4096;

/// Builds `cell` over the mesh in `input` and measures the build.
///
/// # Errors
/// One line: a malformed mesh, a builder that failed, or a system that does not tell.
pub fn answer(input: impl Read, cell: &Cell, pool: &ThreadPool) -> Result<BuildMemory, String> {
    let mesh = mesh_stream::read(input)?;
    let contender = Contender::of(cell)?;
    // Code, threads and their stacks are resident before.
    drop(contender.once(&beginning(&mesh)?, pool)?);
    resident::trim();
    resident::reset_peak()?;
    let before = resident::now()?;
    let built = contender.once(&mesh, pool)?;
    let peak = resident::peak()?;
    resident::trim();
    let after = resident::now()?;
    drop(built);
    Ok(BuildMemory { peak_bytes: peak.saturating_sub(before), live_bytes: after.saturating_sub(before) })
}

/// A mesh of the first [`FEW`] triangles.
fn beginning(mesh: &Mesh) -> Result<Mesh, String> {
    let few = mesh.triangles().iter().take(FEW);
    let vertices: Vec<_> = few.flatten().filter_map(|&i| mesh.vertices().get(i as usize).copied()).collect();
    let triangles = (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new(vertices, triangles).map(|(mesh, _)| mesh).map_err(|error| error.to_string())
}
