//! The settings of a run, which must be the same where it is resumed.

use crate::bench::error::PlanError;
use crate::trace::PathSettings;
use serde::{Deserialize, Serialize};

/// Threads of any verb.
pub const MOST_THREADS: usize = 1 << 10;
/// Seconds of a day, the most that anything may go on.
pub const MOST_SECONDS: u64 = 24 * 60 * 60;

/// The settings of a run. A resumed run must have the same, except for those that say when it ends.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Settings {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Views per scene, at most.
    pub views: usize,
    /// Longest path, in segments.
    pub max_depth: u32,
    /// Visits to each cell, at least.
    pub rounds: usize,
    /// Seconds to spend in each scene, at least: rounds are added until they have passed.
    #[serde(default)]
    pub seconds: u64,
    /// Half the 95 % interval that the means over scenes may have, in thousandths: rounds are added until every
    /// scene has its share of that. 0: none are.
    #[serde(default)]
    pub until_permille: u32,
    /// Seconds in a scene after which no round is added for that.
    #[serde(default)]
    pub limit: u64,
    /// Threads of each side.
    pub threads: usize,
    /// Seed of the paths and of the order of visits.
    pub seed: u64,
    /// Only builds are timed.
    pub build_only: bool,
    /// Builds are timed on one thread too.
    #[serde(default)]
    pub one_thread: bool,
    /// Whole path-traced frames are timed beside the recorded rays.
    pub frames: bool,
}

impl Settings {
    /// Views of `size` x `size` pixels with paths of up to eight segments; every cell is visited `rounds` times.
    pub fn new(size: u32, views: usize, rounds: usize, threads: usize) -> Self {
        Self {
            width: size,
            height: size,
            views,
            max_depth: 8,
            rounds,
            seconds: 0,
            until_permille: 0,
            limit: 0,
            threads,
            seed: 1,
            build_only: false,
            one_thread: false,
            frames: false,
        }
    }

    /// The path tracer's settings.
    pub fn path(&self) -> PathSettings {
        PathSettings { width: self.width, height: self.height, max_depth: self.max_depth, seed: self.seed }
    }

    /// Whether `round` is to be run in one of `scenes` whose rounds so far took `spent` seconds and left intervals of
    /// `width` to either side.
    pub fn wants(&self, round: usize, spent: f64, scenes: usize, width: impl FnOnce() -> f64) -> bool {
        round < self.rounds
            || spent < self.seconds as f64
            || spent < self.limit as f64 && self.is_wide(scenes, width)
    }

    /// Whether narrow intervals are asked for and `width`, of one of `scenes`, is not narrow: the error of a mean
    /// is that of its scenes over the root of their number.
    pub fn is_wide(&self, scenes: usize, width: impl FnOnce() -> f64) -> bool {
        self.until_permille > 0 && width() > 0.001 * f64::from(self.until_permille) * (scenes as f64).sqrt()
    }

    /// Refuses values out of range.
    ///
    /// # Errors
    /// [`PlanError`] of the first such value.
    pub fn check(&self) -> Result<(), PlanError> {
        let counts = [
            ("size", self.width as usize, 1 << 14),
            ("size", self.height as usize, 1 << 14),
            ("views", self.views, 1 << 10),
            ("rounds", self.rounds, 1 << 16),
            ("threads", self.threads, MOST_THREADS),
        ];
        if self.seconds > MOST_SECONDS {
            return Err(PlanError::TooMuch {
                option: "seconds",
                value: self.seconds as usize,
                most: MOST_SECONDS as usize,
            });
        }
        for (option, value, most) in counts {
            if value == 0 {
                return Err(PlanError::Zero(option));
            }
            if value > most {
                return Err(PlanError::TooMuch { option, value, most });
            }
        }
        match self {
            Self { one_thread: true, threads: 1, .. } => {
                Err(PlanError::OneThread("beside --threads 1: the same twice; leave it out"))
            }
            // Embree's devices share threads, as many as the device of most: what traces would lend its own.
            Self { one_thread: true, build_only: false, .. } => Err(PlanError::OneThread(
                "without --build-only: Embree would build with the threads that trace",
            )),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_are_added_until_the_time_is_over() {
        let settings = Settings { rounds: 3, seconds: 60, ..Settings::new(8, 1, 1, 1) };
        let wants = |settings: &Settings, round, seconds: f64| settings.wants(round, seconds, 4, || 0.05);
        assert!(wants(&settings, 2, 1e3) && !wants(&settings, 3, 1e3));
        assert!(wants(&settings, 3, 59.0) && wants(&settings, 300, 59.0) && !wants(&settings, 3, 60.0));
        let settings = Settings { seconds: 0, ..settings };
        assert!(!wants(&settings, 3, 0.0));
        // Four scenes of 5 % are a mean of 2.5 %.
        let until = |until_permille| Settings { until_permille, limit: 90, ..settings.clone() };
        assert!(wants(&until(20), 3, 89.0) && !wants(&until(20), 3, 90.0) && !wants(&until(26), 3, 0.0));
    }
}
