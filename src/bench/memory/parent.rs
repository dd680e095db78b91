//! Starts the process that builds once.

use super::BuildMemory;
use super::mesh_stream;
use crate::bench::cell::Cell;
use crate::geometry::Mesh;
use std::path::Path;
use std::process::{Command, Stdio};

/// Measures a build of `cell` over `mesh` with so many `threads` in a process of its own, started from `program`:
/// this one.
///
/// # Errors
/// One line: no such process, or the one that it ended with.
pub fn measure(program: &Path, mesh: &Mesh, cell: &Cell, threads: usize) -> Result<BuildMemory, String> {
    let failed = |error: std::io::Error| format!("{} memory: {error}", program.display());
    let mut child = Command::new(program)
        .args(["memory", "--builder", cell.made_by()])
        .args(["--width", &cell.width.to_string(), "--threads", &threads.to_string()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(failed)?;
    // It is piped. A process that ends early says why in its last line.
    let sent = child.stdin.take().map_or(Ok(()), |input| mesh_stream::write(mesh, input));
    let output = child.wait_with_output().map_err(failed)?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        return Err(text.lines().last().unwrap_or("the process that builds once failed").into());
    }
    sent.map_err(failed)?;
    serde_json::from_slice(&output.stdout).map_err(|error| format!("{} memory: {error}", program.display()))
}
