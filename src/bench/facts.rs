//! What a visit tells of a builder beside its traces: how long its builds took, and what its tree is like.

use super::load::Load;
use crate::bvh::Statistics;
use serde::{Deserialize, Serialize};

/// Durations of one visit's builds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Builds {
    /// The first build of a fresh builder object or device, in fresh memory, ms.
    pub cold_ms: f64,
    /// The builds after it, ours in the memory of the tree before, ms.
    pub warm_ms: Vec<f64>,
    /// Parts of the last build, ms; empty for Embree, which does not tell.
    pub phases: Vec<(String, f64)>,
    /// Bytes held at the peak of the last build.
    pub peak_bytes: Option<u64>,
    /// What the processors did during the warm builds.
    pub load: Load,
    /// Warm builds on one thread, if wanted.
    #[serde(default)]
    pub one_thread: Option<OnOneThread>,
}

/// Builds on one thread, beside those on all.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OnOneThread {
    /// Warm builds, ms.
    pub warm_ms: Vec<f64>,
    /// What the processors did meanwhile.
    pub load: Load,
}

/// What is known of a tree beside its speed; what could not be had is absent.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Facts {
    /// Who built it, with version.
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

impl Facts {
    /// Those of a tree in our own form.
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
