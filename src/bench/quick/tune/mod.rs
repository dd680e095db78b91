//! Searches the parameters of a builder for a scene and a number of rays: what takes the least time in all, relative to
//! an anchor that is measured right before each trial, so that drift hits both.
//!
//! [`space`] holds the parameters, of which [`scale`] makes numbers, [`proposals`] chooses points by a tree-structured
//! Parzen estimator, [`search`] measures: the builders of the space, then points, then a race of the best, and last the
//! winner and the anchor with rays that no choice was made by, so that the gain is not that of the luckiest draw.

pub mod proposals;
pub mod scale;
pub mod search;
pub mod space;

use super::QuickVisit;
use super::line::Estimate;
use crate::bench::cell::Cell;
use crate::bench::turns::paired::PairedMean;
use crate::builders::Recipe;

/// A configuration that was tried.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Builder and width.
    pub cell: Cell,
    /// The configuration.
    pub recipe: Recipe,
    /// Visits, each after one to the anchor.
    pub pairs: Vec<Pair>,
}

/// A visit to a configuration and the one to the anchor right before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// The configuration.
    pub tried: QuickVisit,
    /// The anchor.
    pub anchor: QuickVisit,
}

impl Pair {
    /// Build time, time per ray and total time for `rays`, relative to the anchor's.
    pub fn ratios(&self, rays: f64) -> [f64; 3] {
        let total = |visit: &QuickVisit| visit.build_ms + 1e-6 * visit.ns_per_ray * rays;
        [
            self.tried.build_ms / self.anchor.build_ms,
            self.tried.ns_per_ray / self.anchor.ns_per_ray,
            total(&self.tried) / total(&self.anchor),
        ]
    }
}

/// The means of [`Pair::ratios`] with Student's 95 % intervals, which are endless for one pair.
pub fn mean_ratios(pairs: &[Pair], rays: f64) -> [Estimate; 3] {
    [0, 1, 2].map(|figure| {
        let logs: Vec<f64> = pairs.iter().map(|pair| pair.ratios(rays)[figure].ln()).collect();
        PairedMean::of(std::iter::once(&logs[..])).ratio()
    })
}

/// What a search found.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// What all is relative to.
    pub anchor: Cell,
    /// All configurations, each with the pair of the search, in the order tried.
    pub trials: Vec<Trial>,
    /// Trials that failed: the configuration and why.
    pub failures: Vec<(String, String)>,
    /// Those of the race, with its pairs alone, the best first.
    pub race: Vec<Trial>,
    /// The best of the race and the anchor, measured again with other rays.
    pub fresh: Trial,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_are_to_the_anchor_of_the_same_pair() {
        let visit = |build_ms, ns_per_ray| QuickVisit { build_ms, ns_per_ray };
        let pair = |drift: f64| Pair {
            tried: visit(200.0 * drift, 80.0 * drift),
            anchor: visit(100.0 * drift, 100.0 * drift),
        };
        let expected = [2.0, 0.8, 1000.0 / 1100.0];
        assert!(pair(1.0).ratios(1e7).iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
        let [build, ray, total] = mean_ratios(&[pair(1.0), pair(1.5), pair(0.7)], 1e7);
        assert!((build.value - 2.0).abs() < 1e-9 && (build.high - build.low) < 1e-9, "drift is no noise");
        assert!((ray.value - 0.8).abs() < 1e-9 && (total.value - 1.0 / 1.1).abs() < 1e-9);
        assert_eq!(mean_ratios(&[pair(1.0)], 1e7)[2].high, f64::INFINITY);
    }
}
