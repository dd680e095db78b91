//! Facts of a tree: its cost, size and shape, untimed.

use crate::bvh::Statistics;
use serde::{Deserialize, Serialize};

/// Facts of a tree; `None` where a figure is unavailable.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TreeFacts {
    /// The engine that built it, with version.
    pub engine: String,
    /// The builder's parameters.
    pub config: String,
    /// SAH cost.
    pub sah: Option<f64>,
    /// End-point overlap.
    pub epo: Option<f64>,
    /// Inner nodes.
    pub nodes: Option<u64>,
    /// Leaves.
    pub leaves: Option<u64>,
    /// Levels of inner nodes.
    pub depth: Option<u64>,
    /// Used lanes of leaf blocks.
    pub leaf_fill: Option<f64>,
    /// References per triangle.
    pub refs_per_tri: Option<f64>,
    /// Bytes of the tree.
    pub bytes: Option<u64>,
}

impl TreeFacts {
    /// The facts of a tree in our form.
    pub fn of(statistics: &Statistics, engine: String, config: String) -> Self {
        Self {
            engine,
            config,
            sah: Some(statistics.sah),
            epo: Some(statistics.epo),
            nodes: Some(statistics.nodes as u64),
            leaves: Some(statistics.leaves as u64),
            depth: Some(statistics.depth as u64),
            leaf_fill: Some(statistics.leaf_fill),
            refs_per_tri: Some(statistics.references_per_triangle),
            bytes: Some(statistics.bytes as u64),
        }
    }
}
