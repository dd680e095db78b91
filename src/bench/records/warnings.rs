//! Named defects of a measurement. Rows carry the names; the table and the summary add advice.

#![allow(clippy::indexing_slicing, reason = "of the samples that the summary is of: there are some")]

use super::statistics::Summary;
use crate::bench::cpu_time::{CpuTime, DISTURBED};
use serde::{Deserialize, Serialize};

/// A defect of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Warning {
    /// Fewer than [`ENOUGH_SAMPLES`] samples.
    TooFewSamples,
    /// The median absolute deviation exceeds [`SPREAD`] of the median.
    HighSpread,
    /// The first sample is much slower than the others.
    SlowFirst,
    /// Some sample lies far outside the others.
    Outliers,
    /// Other programs held the processors.
    Contended,
    /// More threads ran than were asked for.
    ThreadMismatch,
    /// The run ended before all rounds were done.
    Unfinished,
}

/// With fewer samples a median means little.
pub const ENOUGH_SAMPLES: usize = 3;
/// Largest share of the median that its absolute deviation may have.
pub const SPREAD: f64 = 0.05;
/// How much slower a first sample may be than the median of the rest.
const FIRST: f64 = 1.25;
/// Largest distance from the median, in deviations that equal sigma for normal noise.
const OUTLYING: f64 = 7.0;
/// Shortest wall time, seconds, for which CPU time is meaningful.
const SHORTEST: f64 = 0.02;

impl Warning {
    /// All warnings.
    pub const ALL: [Self; 7] = [
        Self::TooFewSamples,
        Self::HighSpread,
        Self::SlowFirst,
        Self::Outliers,
        Self::Contended,
        Self::ThreadMismatch,
        Self::Unfinished,
    ];

    /// The name in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::TooFewSamples => "TooFewSamples",
            Self::HighSpread => "HighSpread",
            Self::SlowFirst => "SlowFirst",
            Self::Outliers => "Outliers",
            Self::Contended => "Contended",
            Self::ThreadMismatch => "ThreadMismatch",
            Self::Unfinished => "Unfinished",
        }
    }

    /// Its meaning and the remedy.
    pub fn advice(self) -> &'static str {
        match self {
            Self::TooFewSamples => {
                "fewer than 3 samples tell nothing of their spread; use --rounds 5 or more"
            }
            Self::HighSpread => "samples differ by more than 5 %; close other programs or use more --rounds",
            Self::SlowFirst => {
                "the first round was much slower; pages or clocks were cold, judge by median and min"
            }
            Self::Outliers => "single samples lie far off; something interfered, look into samples.json",
            Self::Contended => {
                "other programs held the processors; run again on an idle machine or with fewer --threads"
            }
            Self::ThreadMismatch => {
                "not as many threads ran as were asked for; give --threads no more than the processors allow"
            }
            Self::Unfinished => "the run was stopped before all rounds; finish it with --resume",
        }
    }

    /// The defects of the samples of one figure, in the order in which they were taken.
    pub fn of_samples(samples: &[f64]) -> Vec<Self> {
        let Some(summary) = Summary::of(samples) else { return vec![Self::TooFewSamples] };
        if samples.len() < ENOUGH_SAMPLES {
            return vec![Self::TooFewSamples];
        }
        let mut warnings = Vec::new();
        if summary.mad > SPREAD * summary.median {
            warnings.push(Self::HighSpread);
        }
        if Summary::of(&samples[1..]).is_some_and(|rest| samples[0] > FIRST * rest.median) {
            warnings.push(Self::SlowFirst);
        }
        // A hundredth of the median keeps clock noise of very steady samples from counting.
        let sigma = 1.4826 * summary.mad.max(0.01 * summary.median);
        if samples[1..].iter().any(|x| (x - summary.median).abs() > OUTLYING * sigma) {
            warnings.push(Self::Outliers);
        }
        warnings
    }

    /// The defects that the CPU time of a span shows, with `threads` asked for.
    pub fn of_cpu_time(time: &CpuTime, threads: usize) -> Vec<Self> {
        let mut warnings = Vec::new();
        if time.wall_s < SHORTEST {
            return warnings;
        }
        if time.waiting() > DISTURBED {
            warnings.push(Self::Contended);
        }
        if time.ran_s > 1.1 * threads as f64 * time.wall_s {
            warnings.push(Self::ThreadMismatch);
        }
        warnings
    }

    /// The names in `column` of a row that are warnings.
    pub fn parse(column: &str) -> impl Iterator<Item = Self> + '_ {
        column.split(';').filter_map(|name| Self::ALL.into_iter().find(|warning| warning.name() == name))
    }

    /// The column of a row: each name once, in a fixed order.
    pub fn join(warnings: &[Self]) -> String {
        let mut sorted = warnings.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        sorted.iter().map(|warning| warning.name()).collect::<Vec<_>>().join(";")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steady_samples_are_fine() {
        assert_eq!(Warning::of_samples(&[10.0, 10.1, 9.9, 10.0, 10.05]), []);
    }

    #[test]
    fn each_defect_is_named() {
        assert_eq!(Warning::of_samples(&[10.0, 10.0]), [Warning::TooFewSamples]);
        assert_eq!(Warning::of_samples(&[]), [Warning::TooFewSamples]);
        assert_eq!(Warning::of_samples(&[10.0, 12.0, 8.0, 11.5, 9.0]), [Warning::HighSpread]);
        assert_eq!(Warning::of_samples(&[20.0, 10.0, 10.1, 9.9, 10.0]), [Warning::SlowFirst]);
        assert_eq!(Warning::of_samples(&[10.0, 10.0, 10.1, 9.9, 20.0]), [Warning::Outliers]);
    }

    #[test]
    fn cpu_time_shows_contention_and_wrong_threads() {
        let time = |wall_s, ran_s, waited_s| CpuTime { wall_s, ran_s, waited_s };
        assert_eq!(Warning::of_cpu_time(&time(1.0, 1.9, 0.01), 2), []);
        assert_eq!(Warning::of_cpu_time(&time(1.0, 1.0, 0.9), 2), [Warning::Contended]);
        assert_eq!(Warning::of_cpu_time(&time(1.0, 3.9, 0.0), 2), [Warning::ThreadMismatch]);
        assert_eq!(Warning::of_cpu_time(&time(0.001, 1.0, 1.0), 2), []);
    }

    #[test]
    fn columns_round_trip() {
        let column = Warning::join(&[Warning::Outliers, Warning::HighSpread, Warning::Outliers]);
        assert_eq!(column, "HighSpread;Outliers");
        assert_eq!(Warning::parse(&column).collect::<Vec<_>>(), [Warning::HighSpread, Warning::Outliers]);
        assert_eq!(Warning::parse("").count(), 0);
        assert!(Warning::ALL.into_iter().all(|w| Warning::parse(w.name()).eq([w])));
    }
}
