//! Cut sizes as CSV.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use crate::bench::statistics::figures;
use crate::builders::cuts_of;
use crate::builders::steps::watch::cut_sizes;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// The file in a results folder.
pub const CUT_SIZES: &str = "cut-size.csv";

/// The cuts of a depth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CutSizeRow {
    /// Scene name.
    pub scene: String,
    /// Triangles of the scene.
    pub triangles: u64,
    /// Builder name.
    pub builder: String,
    /// Binary splits above.
    pub depth: u32,
    /// Cuts that were split.
    pub cuts: u64,
    /// Their nodes, all together.
    pub nodes: u64,
    /// Nodes per cut.
    pub mean_nodes: f64,
}

/// Builds `scene` by each of `builders` on the current rayon pool and counts.
///
/// # Errors
/// A builder without cuts, in one line.
pub fn measure(scene: &Scene, builders: &[&str]) -> Result<Vec<CutSizeRow>, String> {
    let mut rows = Vec::new();
    for &builder in builders {
        let config = cuts_of(builder)
            .ok_or_else(|| format!("{builder} has no cuts; give phr-fast, hunt-50 or the like"))?;
        let sizes = cut_sizes(&scene.mesh, &config).map_err(|error| format!("{builder}: {error}"))?;
        rows.extend(sizes.into_iter().map(|at| CutSizeRow {
            scene: scene.name.clone(),
            triangles: scene.mesh.len() as u64,
            builder: builder.into(),
            depth: at.depth,
            cuts: at.cuts,
            nodes: at.nodes,
            mean_nodes: figures(at.nodes as f64 / at.cuts as f64),
        }));
    }
    Ok(rows)
}
