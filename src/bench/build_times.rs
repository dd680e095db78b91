//! What a visit tells of a builder beside its traces: how long its builds took, and what its tree is like.

use super::cpu_time::CpuTime;
use serde::{Deserialize, Serialize};

/// Durations of one visit's builds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BuildTimes {
    /// The first build of a fresh builder object or device, in fresh memory, ms.
    pub cold_ms: f64,
    /// The builds after it, ours in the memory of the tree before, ms.
    pub warm_ms: Vec<f64>,
    /// Parts of the last build, ms; empty for Embree, which does not tell.
    pub phases: Vec<(String, f64)>,
    /// Bytes held at the peak of the last build.
    pub peak_bytes: Option<u64>,
    /// What the processors did during the warm builds.
    pub load: CpuTime,
    /// Warm builds on one thread, if wanted.
    #[serde(default)]
    pub one_thread: Option<OneThreadTimes>,
}

/// BuildTimes on one thread, beside those on all.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OneThreadTimes {
    /// Warm builds, ms.
    pub warm_ms: Vec<f64>,
    /// What the processors did meanwhile.
    pub load: CpuTime,
}
