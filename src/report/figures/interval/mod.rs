//! 95 % intervals of means of ratios, by bootstrap: scenes are drawn with replacement, and in each drawn scene
//! rounds. The times of two builders stay paired within a round, since rounds are interleaved and drift hits both.
//! Draws are centred on the figure, and deviations known from few scenes or rounds are enlarged as Student's.
//! Generators are seeded, so that the same rows give the same interval.

mod arithmetic;
mod noise;

pub use arithmetic::of_arithmetic_mean;
pub use noise::{LEAST_ROUNDS, Noise, Pairs, wider};

use crate::random::SplitMix64;
use noise::student;

/// Draws behind an interval.
const DRAWS: usize = 2000;
const SEED: u64 = 0x9d2c_5680;

/// A ratio in a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneRatio {
    /// The scene.
    pub scene: String,
    /// The ratio.
    pub value: f64,
    /// What is known of its noise.
    pub noise: Noise,
}

impl SceneRatio {
    /// Its interval over rounds.
    pub fn interval(&self) -> Interval {
        of_mean(std::slice::from_ref(self), Over::Rounds).unwrap_or(Interval::UNKNOWN)
    }
}

/// The ends of a 95 % interval; from 0 to infinity where nothing is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self { low: 0.0, high: f64::INFINITY };

    /// The middle 95 % of `drawn`, made to hold `value`; unknown if some draw is no number.
    fn of(mut drawn: Vec<f64>, value: f64) -> Self {
        if drawn.iter().any(|x| !x.is_finite()) || !value.is_finite() {
            return Self::UNKNOWN;
        }
        drawn.sort_by(f64::total_cmp);
        let (low, high) = (drawn[DRAWS / 40], drawn[DRAWS - 1 - DRAWS / 40]);
        Self { low: low.min(value), high: high.max(value) }
    }

    /// Half its width relative to `value`; infinite where nothing is known.
    pub fn half_width(&self, value: f64) -> f64 {
        0.5 * (self.high - self.low) / value
    }

    /// As it stands behind a figure: `[0.84, 0.90]`, or `[?]`.
    pub fn shown(&self, digits: usize) -> String {
        if self.high.is_finite() {
            format!("[{:.digits$}, {:.digits$}]", self.low, self.high)
        } else {
            "[?]".into()
        }
    }
}

/// What is drawn again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Scenes and rounds: what the mean would be over other scenes of the kind.
    ScenesAndRounds,
    /// Rounds alone: what another measurement of the same scenes would give.
    Rounds,
}

/// The interval of the geometric mean of `ratios`; `None` for none. Over scenes, one scene alone tells nothing.
pub fn of_mean(ratios: &[SceneRatio], over: Over) -> Option<Interval> {
    match (ratios.len(), over) {
        (0, _) => None,
        (1, Over::ScenesAndRounds) => Some(Interval::UNKNOWN),
        _ => {
            let mean = mean_logarithm(ratios);
            Some(Interval::of(logarithms(ratios, over, SEED).map(f64::exp).collect(), mean.exp()))
        }
    }
}

/// The interval of the geometric mean of `ratios` relative to that of `others`, which are of other scenes: both are
/// drawn again. `None` for none, unknown where one of them is of one scene.
pub fn of_quotient(ratios: &[SceneRatio], others: &[SceneRatio]) -> Option<Interval> {
    match ratios.len().min(others.len()) {
        0 => None,
        1 => Some(Interval::UNKNOWN),
        _ => {
            let over = Over::ScenesAndRounds;
            let drawn = logarithms(ratios, over, SEED).zip(logarithms(others, over, !SEED));
            let quotient = (mean_logarithm(ratios) - mean_logarithm(others)).exp();
            Some(Interval::of(drawn.map(|(above, below)| (above - below).exp()).collect(), quotient))
        }
    }
}

fn mean_logarithm(ratios: &[SceneRatio]) -> f64 {
    ratios.iter().map(|ratio| ratio.value.ln()).sum::<f64>() / ratios.len() as f64
}

/// Logarithms of the geometric mean of some ratios, as drawn again; their own mean is that of the ratios.
fn logarithms(ratios: &[SceneRatio], over: Over, seed: u64) -> impl Iterator<Item = f64> {
    let count = ratios.len();
    let mean = mean_logarithm(ratios);
    let (mut random, mut scratch) = (SplitMix64::new(seed), Vec::new());
    let wider = if over == Over::Rounds { 0.0 } else { wider(count) };
    let student = student(ratios.iter().map(|ratio| &ratio.noise));
    let mut draw = || {
        let (mut of_scenes, mut of_rounds) = (0.0, 0.0);
        for scene in 0..count {
            let scene = if over == Over::Rounds { scene } else { random.below(count) };
            of_scenes += (ratios[scene].value.ln() - mean) / count as f64;
            of_rounds += ratios[scene].noise.draw(&mut random, &mut scratch, student) / count as f64;
        }
        (wider * of_scenes, of_rounds)
    };
    let drawn: Vec<(f64, f64)> = (0..DRAWS).map(|_| draw()).collect();
    // The median of few rounds drawn again is not, on average, that of all.
    let centre = drawn.iter().map(|(_, of_rounds)| of_rounds).sum::<f64>() / DRAWS as f64;
    drawn.into_iter().map(move |(of_scenes, of_rounds)| mean + of_scenes + of_rounds - centre)
}

#[cfg(test)]
mod tests {
    use super::noise::normal;
    use super::*;
    use crate::bench::statistics::Summary;

    fn exact(values: &[f64]) -> Vec<SceneRatio> {
        let ratio =
            |(i, &value): (usize, &f64)| SceneRatio { scene: i.to_string(), value, noise: Noise::NONE };
        values.iter().enumerate().map(ratio).collect()
    }

    /// Two builders whose times drift together by a factor of two, their ratio 0.5 within `spread`.
    fn drifting(rounds: usize, spread: f64, seed: u64) -> SceneRatio {
        let mut random = SplitMix64::new(seed);
        let pair = |_| {
            let drift = 10.0 * 2f64.powf(normal(&mut random));
            [0.5 * drift * (spread * normal(&mut random)).exp(), drift]
        };
        let pairs = Pairs::new((0..rounds).map(pair).collect());
        SceneRatio { scene: "s".into(), value: pairs.ratio, noise: Noise::Rounds(pairs) }
    }

    #[test]
    fn drift_that_hits_both_cancels() {
        let interval = of_mean(&[drifting(9, 0.0, 1)], Over::Rounds).unwrap();
        assert!((interval.high - interval.low).abs() < 1e-12, "{interval:?}");
        let SceneRatio { noise: Noise::Rounds(pairs), .. } = drifting(9, 0.0, 1) else { unreachable!() };
        let apart = |side: usize| {
            Summary::of(&pairs.pairs.iter().map(|pair| pair[side]).collect::<Vec<_>>()).unwrap()
        };
        let Noise::Error(error) = Noise::of(&apart(0), &apart(1), Vec::new()) else { panic!() };
        assert!(error > 0.1, "without pairs the drift counts as noise: {error}");
    }

    /// 95 of 100 intervals should hold the truth; each is of twelve scenes of three rounds.
    #[test]
    fn intervals_over_rounds_hold_the_truth_about_as_often_as_they_say() {
        let holds = |run: u64| {
            let scenes: Vec<SceneRatio> =
                (0..12).map(|scene| drifting(3, 0.05, 1000 * run + scene)).collect();
            let interval = of_mean(&scenes, Over::Rounds).unwrap();
            interval.low <= 0.5 && 0.5 <= interval.high
        };
        let held = (0..100).filter(|&run| holds(run)).count();
        assert!((88..=100).contains(&held), "{held}");
    }

    /// 95 of 100 intervals over scenes should hold the truth, of few scenes too.
    #[test]
    fn intervals_over_few_scenes_hold_the_truth_about_as_often_as_they_say() {
        for scenes in [3, 5, 9, 19] {
            let holds = |run: u64| {
                let mut random = SplitMix64::new(run);
                let values: Vec<f64> = (0..scenes).map(|_| (0.2 * normal(&mut random)).exp()).collect();
                let interval = of_mean(&exact(&values), Over::ScenesAndRounds).unwrap();
                interval.low <= 1.0 && 1.0 <= interval.high
            };
            let held = (0..300).filter(|&run| holds(31 * run)).count();
            assert!((270..=300).contains(&held), "{held} of {scenes} scenes");
        }
    }

    #[test]
    fn intervals_over_scenes_are_those_of_a_normal_mean() {
        let mut random = SplitMix64::new(5);
        let values: Vec<f64> = (0..40).map(|_| (0.2 * normal(&mut random)).exp()).collect();
        let logs: Vec<f64> = values.iter().map(|value| value.ln()).collect();
        let mean = logs.iter().sum::<f64>() / 40.0;
        let error = (logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / 39.0 / 40.0).sqrt();
        let interval = of_mean(&exact(&values), Over::ScenesAndRounds).unwrap();
        let half = 0.5 * (interval.high.ln() - interval.low.ln());
        assert!((half / (1.96 * error) - 1.0).abs() < 0.1, "{half} {error}");
        let rounds = of_mean(&exact(&values), Over::Rounds).unwrap();
        assert!((rounds.low - mean.exp()).abs() < 1e-12 && (rounds.high - mean.exp()).abs() < 1e-12);
    }

    #[test]
    fn the_error_of_a_mean_is_that_of_its_scenes_over_their_root() {
        let scene = |i: usize| SceneRatio { scene: i.to_string(), value: 2.0, noise: Noise::Error(0.03) };
        let interval = of_mean(&(0..9).map(scene).collect::<Vec<_>>(), Over::Rounds).unwrap();
        assert!((interval.half_width(2.0) / (1.96 * 0.01) - 1.0).abs() < 0.1, "{interval:?}");
    }

    /// The same of a single scene, whose three rounds tell little of their own spread.
    #[test]
    fn intervals_of_a_scene_hold_the_truth_about_as_often_as_they_say() {
        let holds = |seed: u64| {
            let interval = drifting(3, 0.05, seed).interval();
            interval.low <= 0.5 && 0.5 <= interval.high
        };
        let held = (0..400).filter(|&run| holds(7000 + run)).count();
        assert!((365..=395).contains(&held), "{held}");
    }

    #[test]
    fn draws_are_centred_on_the_figure() {
        // The median is the least of three: drawn again it can only grow.
        let pairs = Pairs::new(vec![[1.0, 1.0], [1.0, 1.0], [1.5, 1.0]]);
        let scene = SceneRatio { scene: "s".into(), value: 1.0, noise: Noise::Rounds(pairs) };
        let scenes = vec![scene; 40];
        for interval in [of_mean(&scenes, Over::Rounds).unwrap(), of_arithmetic_mean(&scenes).unwrap()] {
            assert!(interval.high - interval.low > 0.05, "{interval:?}");
            assert!(((interval.low * interval.high).sqrt() - 1.0).abs() < 0.01, "{interval:?}");
        }
    }

    #[test]
    fn quotients_are_as_unsure_as_both_means() {
        let mut random = SplitMix64::new(8);
        let mut run = |centre: f64, count: usize| {
            exact(&(0..count).map(|_| centre * (0.2 * normal(&mut random)).exp()).collect::<Vec<_>>())
        };
        let (a, b) = (run(2.0, 40), run(1.0, 30));
        let [of_a, of_b] = [&a, &b].map(|run| of_mean(run, Over::ScenesAndRounds).unwrap());
        let quotient = of_quotient(&a, &b).unwrap();
        let wide = |interval: &Interval| (interval.high / interval.low).ln();
        assert!((wide(&quotient) / wide(&of_a).hypot(wide(&of_b)) - 1.0).abs() < 0.1, "{quotient:?}");
        assert!(quotient.low < 2.0 && 2.0 < quotient.high && quotient.low > 1.7, "{quotient:?}");
        assert_eq!(of_quotient(&a, &[]), None);
        assert_eq!(of_quotient(&a, &b[..1]), Some(Interval::UNKNOWN));
    }

    #[test]
    fn what_is_not_known_is_not_claimed() {
        assert_eq!(of_mean(&[], Over::Rounds), None);
        let one = exact(&[0.5]);
        assert_eq!(of_mean(&one, Over::ScenesAndRounds), Some(Interval::UNKNOWN));
        let single = Summary::of(&[5.0]).unwrap();
        let unknown = SceneRatio { noise: Noise::of(&single, &single, Vec::new()), ..one[0].clone() };
        assert_eq!(of_mean(std::slice::from_ref(&unknown), Over::Rounds), Some(Interval::UNKNOWN));
        assert_eq!(Interval::UNKNOWN.shown(2), "[?]");
    }
}
