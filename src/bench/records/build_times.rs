//! How long the builds of one visit took.

use crate::bench::cpu_time::CpuTime;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Durations of one visit's builds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BuildTimes {
    /// The first build of a new builder object or device, in fresh memory, ms.
    pub cold_ms: f64,
    /// The builds after it.
    #[serde(flatten)]
    pub warm: WarmTimes,
    /// Phases of the last build, ms; empty for Embree, which reports none.
    pub phases: Vec<(String, f64)>,
    /// Bytes held at the peak of the last build.
    pub peak_bytes: Option<u64>,
    /// Warm builds on one thread, where they were asked for.
    #[serde(default)]
    pub one_thread: Option<WarmTimes>,
}

/// Durations of warm builds: memory, pools and builder were in use before, and ours reuse the memory of the
/// tree before.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WarmTimes {
    /// Each build, ms.
    #[serde(rename = "warm_ms")]
    pub ms: Vec<f64>,
    /// CPU time of these builds.
    #[serde(rename = "load")]
    pub cpu_time: CpuTime,
}

/// Whether a visit has enough warm builds: five, or 60 ms of them.
pub fn is_enough(warm: &[Duration]) -> bool {
    warm.len() >= 5 || warm.iter().sum::<Duration>() >= Duration::from_millis(60)
}

/// Milliseconds.
pub fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_names_in_the_samples_stay() {
        let warm = WarmTimes { ms: vec![1.5, 2.0], cpu_time: CpuTime::default() };
        let times =
            BuildTimes { cold_ms: 3.0, warm: warm.clone(), one_thread: Some(warm), ..BuildTimes::default() };
        let json = serde_json::to_value(&times).unwrap();
        for key in ["cold_ms", "warm_ms", "load", "phases", "peak_bytes", "one_thread"] {
            assert!(json.get(key).is_some(), "{key}: {json}");
        }
        assert!(json["one_thread"]["warm_ms"][0] == 1.5 && json["one_thread"]["load"]["wall_s"] == 0.0);
        assert_eq!(serde_json::from_value::<BuildTimes>(json).unwrap(), times);
    }
}
