//! Points to be tried next, by a tree-structured Parzen estimator (Bergstra et al. 2011; the crate `tpe`): it takes
//! numbers and lists alike, bears noise, and needs no more trials than there is time for.

use super::space::{Point, Space};
use rand::SeedableRng;
use rand::rngs::StdRng;
use tpe::density_estimation::DefaultEstimatorBuilder;
use tpe::{TpeOptimizer, TpeOptimizerBuilder, histogram_estimator, parzen_estimator};

/// The share of trials that count as good.
const GOOD: f64 = 0.2;

/// Proposes points; a seed determines them, as far as the answers do.
pub struct Proposals {
    space: Space,
    optimisers: Vec<TpeOptimizer<DefaultEstimatorBuilder>>,
    random: StdRng,
    /// Numbers that stay as they are.
    fixed: Vec<(usize, f64)>,
}

impl Proposals {
    /// Of points of `space` with `fixed` numbers by index.
    pub fn new(space: Space, seed: u64, fixed: Vec<(usize, f64)>) -> Self {
        let optimiser = |parameter: &super::space::Parameter| {
            let (low, high) = parameter.scale.range();
            let range = tpe::range(low, high).expect("ranges are finite");
            let estimator =
                if parameter.scale.is_list() { histogram_estimator() } else { parzen_estimator() };
            let built = TpeOptimizerBuilder::new().gamma(GOOD).build(estimator, range);
            built.expect("a share is within 0 to 1")
        };
        let optimisers = space.parameters.iter().map(optimiser).collect();
        Self { space, optimisers, random: StdRng::seed_from_u64(seed), fixed }
    }

    /// The next point.
    pub fn propose(&mut self) -> Point {
        let mut point = vec![0.0; self.optimisers.len()];
        for (number, optimiser) in point.iter_mut().zip(&mut self.optimisers) {
            let Ok(asked) = optimiser.ask(&mut self.random);
            *number = asked;
        }
        for &(index, number) in &self.fixed {
            point[index] = number;
        }
        self.space.effective(point)
    }

    /// The value of a point, less is better; infinite for one that failed.
    pub fn tell(&mut self, point: &Point, value: f64) {
        for (&number, optimiser) in point.iter().zip(&mut self.optimisers) {
            // Infinite values would be as good as any other of their kind; a number beyond its range is of no use.
            let _ = optimiser.tell(number, if value.is_finite() { value } else { 1e3 });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noisy, of one list and two numbers; all other parameters have no say.
    #[test]
    fn the_search_comes_near_the_best_of_a_noisy_function() {
        let space = Space::of("phr-quality").unwrap();
        let at =
            |field: &str| space.parameters.iter().position(|parameter| parameter.field == field).unwrap();
        let (delta, threshold, sweep) = (at("delta"), at("spatial_threshold"), at("subtree_sweep"));
        let value = |point: &Point| {
            let list = if point[sweep].floor() == 3.0 { 0.0 } else { 0.3 };
            (0.3 * (point[delta] - 7.0)).abs() + (0.4 * (point[threshold] + 3.0)).abs() + list
        };
        let mut better = 0;
        for seed in 0..5 {
            let mut proposals = Proposals::new(space, seed, vec![(0, 1.5)]);
            let mut random = crate::random::SplitMix64::new(seed);
            let mut last = Vec::new();
            for _ in 0..120 {
                let point = proposals.propose();
                assert_eq!(point[0], 1.5);
                proposals.tell(&point, value(&point) + 0.05 * f64::from(random.unit()));
                last.push(value(&point));
            }
            let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
            better += usize::from(mean(&last[90..]) < 0.6 * mean(&last[..15]));
        }
        assert!(better >= 4, "{better} of 5 searches came nearer");
        let start = space.point_of("phr-quality", 8);
        Proposals::new(space, 1, Vec::new()).tell(&start, f64::INFINITY);
    }
}
