//! The interval of an arithmetic mean, as the paper averages in its Figure 6.

use super::{DRAWS, Interval, SEED, SceneRatio, student, wider};
use crate::random::SplitMix64;

/// The interval of the arithmetic mean of `ratios` over scenes and rounds; `None` for none.
pub fn of_arithmetic_mean(ratios: &[SceneRatio]) -> Option<Interval> {
    let count = ratios.len();
    if count < 2 {
        return ratios.first().map(|_| Interval::UNKNOWN);
    }
    let mean = ratios.iter().map(|ratio| ratio.value).sum::<f64>() / count as f64;
    let wider = wider(count);
    let student = student(ratios.iter().map(|ratio| &ratio.noise));
    let (mut random, mut scratch) = (SplitMix64::new(SEED), Vec::new());
    let mut draw = || {
        let (mut of_scenes, mut of_rounds) = (0.0, 0.0);
        for _ in 0..count {
            let SceneRatio { value, noise, .. } = &ratios[random.below(count)];
            of_scenes += (value - mean) / count as f64;
            of_rounds += value * noise.draw(&mut random, &mut scratch, student).exp_m1() / count as f64;
        }
        (wider * of_scenes, of_rounds)
    };
    let drawn: Vec<(f64, f64)> = (0..DRAWS).map(|_| draw()).collect();
    let centre = drawn.iter().map(|(_, of_rounds)| of_rounds).sum::<f64>() / DRAWS as f64;
    let around = |(of_scenes, of_rounds)| mean + of_scenes + of_rounds - centre;
    Some(Interval::of(drawn.into_iter().map(around).collect(), mean))
}

#[cfg(test)]
mod tests {
    use super::super::Noise;
    use super::super::noise::normal;
    use super::*;

    #[test]
    fn intervals_of_arithmetic_means_are_those_of_a_normal_mean() {
        let mut random = SplitMix64::new(6);
        let values: Vec<f64> = (0..40).map(|_| 2.0 + 0.1 * normal(&mut random)).collect();
        let mean = values.iter().sum::<f64>() / 40.0;
        let error = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 39.0 / 40.0).sqrt();
        let interval = of_arithmetic_mean(&exact(&values)).unwrap();
        assert!((0.5 * (interval.high - interval.low) / (1.96 * error) - 1.0).abs() < 0.1, "{interval:?}");
        assert_eq!(of_arithmetic_mean(&exact(&[1.0])), Some(Interval::UNKNOWN));
    }

    fn exact(values: &[f64]) -> Vec<SceneRatio> {
        let ratio = |&value: &f64| SceneRatio { scene: String::new(), value, noise: Noise::NONE };
        values.iter().map(ratio).collect()
    }
}
