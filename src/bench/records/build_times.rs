//! How long the builds of one visit took.

use crate::bench::cpu_time::CpuTime;
use crate::bench::hardware_counters::Counted;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Durations of one visit's builds, by regime.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BuildTimes {
    /// The first build of a new builder object or device, ms.
    pub first_ms: f64,
    /// New builder objects, each in new memory; Embree: new scenes of the same device.
    pub fresh: WarmTimes,
    /// The same builder object in the memory of the tree before; Embree: the same static scene committed again.
    pub rebuild: WarmTimes,
    /// Embree: the same dynamic scene committed again.
    pub dynamic_rebuild: Option<WarmTimes>,
    /// Phases of the last fresh build, ms; empty for Embree, which reports none.
    pub phases: Vec<(String, f64)>,
    /// Fresh builds on one thread, where they were asked for.
    pub one_thread: Option<WarmTimes>,
}

/// Durations of builds on warm threads.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WarmTimes {
    /// Each build, ms.
    pub ms: Vec<f64>,
    /// CPU time of these builds.
    #[serde(rename = "load")]
    pub cpu_time: CpuTime,
    /// What the processor counted of these builds, where it does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counted: Option<Counted>,
}

/// Whether a visit has enough builds in a regime: five, or 60 ms of them.
pub fn is_enough(builds: &[Duration]) -> bool {
    builds.len() >= 5 || builds.iter().sum::<Duration>() >= Duration::from_millis(60)
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
        let warm = WarmTimes {
            ms: vec![1.5, 2.0],
            counted: Some(Counted { instructions: 7, cycles: 3 }),
            ..WarmTimes::default()
        };
        let times = BuildTimes {
            first_ms: 3.0,
            fresh: warm.clone(),
            one_thread: Some(warm.clone()),
            dynamic_rebuild: Some(warm),
            ..BuildTimes::default()
        };
        let json = serde_json::to_value(&times).unwrap();
        for key in ["first_ms", "fresh", "rebuild", "dynamic_rebuild", "phases", "one_thread"] {
            assert!(json.get(key).is_some(), "{key}: {json}");
        }
        assert!(json["one_thread"]["ms"][0] == 1.5 && json["fresh"]["load"]["wall_s"] == 0.0);
        assert_eq!(json["fresh"]["counted"]["instructions"], 7);
        assert!(json["rebuild"].get("counted").is_none(), "{json}");
        assert_eq!(serde_json::from_value::<BuildTimes>(json).unwrap(), times);
    }
}
