//! 95 % intervals of means of ratios, by bootstrap: scenes are drawn with replacement, and in each drawn scene rounds.
//! The times of two builders stay paired within a round, since rounds are interleaved and drift hits both. Generators
//! are seeded, so that the same rows give the same interval.

mod arithmetic;

pub use arithmetic::of_arithmetic_mean;

use crate::bench::statistics::Summary;
use crate::random::SplitMix64;

/// Draws behind an interval.
const DRAWS: usize = 2000;
const SEED: u64 = 0x9d2c_5680;
/// Rounds below which nothing is said of noise: two that happen to be alike would make any difference sure.
pub const LEAST_ROUNDS: usize = 3;

/// What is known of the noise of a scene's ratio.
#[derive(Clone, Debug, PartialEq)]
pub enum Noise {
    /// Times of both builders in the same rounds.
    Rounds(Pairs),
    /// Only the standard error of the ratio's logarithm, as from medians and deviations; infinite if nothing is known.
    Error(f64),
}

impl Noise {
    /// Of a figure that is the same in every run.
    pub const NONE: Self = Self::Error(0.0);

    /// From the times in rounds that both builders have, else from their summaries. Fewer rounds than [`LEAST_ROUNDS`]
    /// tell nothing.
    pub fn of(a: &Summary, b: &Summary, pairs: Vec<[f64; 2]>) -> Self {
        match pairs.len() {
            0 if a.count.min(b.count) >= LEAST_ROUNDS => {
                Self::Error(a.relative_error().hypot(b.relative_error()) / 1.96)
            }
            LEAST_ROUNDS.. => Self::Rounds(Pairs::new(pairs)),
            _ => Self::Error(f64::INFINITY),
        }
    }

    /// A factor by which the ratio might have come out otherwise.
    fn draw(&self, random: &mut SplitMix64, scratch: &mut Vec<f64>) -> f64 {
        match self {
            Self::Error(error) if *error == 0.0 => 1.0,
            Self::Error(error) => (error * normal(random)).exp(),
            Self::Rounds(pairs) => pairs.draw(random, scratch),
        }
    }
}

/// Two builders' times by round, two rounds at least.
#[derive(Clone, Debug, PartialEq)]
pub struct Pairs {
    pairs: Vec<[f64; 2]>,
    ratio: f64,
}

impl Pairs {
    /// Of `pairs`, two at least.
    pub fn new(pairs: Vec<[f64; 2]>) -> Self {
        let of = |side: usize| median_of(&mut pairs.iter().map(|pair| pair[side]).collect::<Vec<_>>());
        let ratio = of(0) / of(1);
        Self { pairs, ratio }
    }

    /// The ratio of the medians of as many rounds, drawn with replacement, relative to that of all.
    fn draw(&self, random: &mut SplitMix64, scratch: &mut Vec<f64>) -> f64 {
        let count = self.pairs.len();
        let seed = random.clone();
        let mut median = |side: usize, mut random: SplitMix64| {
            scratch.clear();
            scratch.extend((0..count).map(|_| self.pairs[random.below(count)][side]));
            (median_of(scratch), random)
        };
        let (above, _) = median(0, seed.clone());
        let (below, after) = median(1, seed);
        *random = after;
        // Rounds drawn from the few that there are differ too little from each other.
        widened(above / below / self.ratio, count)
    }
}

/// A factor's deviation from 1 in a sample of `count`, two at least, enlarged to that in the population.
fn widened(factor: f64, count: usize) -> f64 {
    let count = count as f64;
    factor.powf((count / (count - 1.0)).sqrt())
}

/// The median of some values, which it sorts.
fn median_of(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
}

/// Normally distributed, of variance 1 (Box and Muller).
fn normal(random: &mut SplitMix64) -> f64 {
    let mut unit = || (random.next_u64() >> 11) as f64 * 2f64.powi(-53);
    let (radius, angle) = ((-2.0 * (1.0 - unit()).ln()).sqrt(), std::f64::consts::TAU * unit());
    radius * angle.cos()
}

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
    const UNKNOWN: Self = Self { low: 0.0, high: f64::INFINITY };

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
    let count = ratios.len();
    let logarithms: Vec<f64> = ratios.iter().map(|ratio| ratio.value.ln()).collect();
    let mean = logarithms.iter().sum::<f64>() / count as f64;
    match (count, over) {
        (0, _) => return None,
        (1, Over::ScenesAndRounds) => return Some(Interval::UNKNOWN),
        _ => {}
    }
    let (mut random, mut scratch) = (SplitMix64::new(SEED), Vec::new());
    let drawn = (0..DRAWS).map(|_| {
        let mut factor = 1.0;
        let mut of_scenes = 0.0;
        for scene in 0..count {
            let scene = if over == Over::Rounds { scene } else { random.below(count) };
            of_scenes += (logarithms[scene] - mean) / count as f64;
            factor *= ratios[scene].noise.draw(&mut random, &mut scratch);
        }
        let of_scenes = if over == Over::Rounds { 1.0 } else { widened(of_scenes.exp(), count) };
        mean.exp() * of_scenes * factor.powf(1.0 / count as f64)
    });
    Some(Interval::of(drawn.collect(), mean.exp()))
}

/// The interval of the worst of `ratios`, which `worse` picks of two, over rounds; `None` for none.
pub fn of_worst(ratios: &[SceneRatio], worse: fn(f64, f64) -> f64) -> Option<Interval> {
    let worst = ratios.iter().map(|ratio| ratio.value).reduce(worse)?;
    let (mut random, mut scratch) = (SplitMix64::new(SEED), Vec::new());
    let mut draw = || {
        let mut values = ratios.iter().map(|ratio| ratio.value * ratio.noise.draw(&mut random, &mut scratch));
        let first = values.next().unwrap_or(f64::NAN);
        // What is no number stays none.
        values.fold(first, |a, b| if a.is_finite() && b.is_finite() { worse(a, b) } else { f64::NAN })
    };
    Some(Interval::of((0..DRAWS).map(|_| draw()).collect(), worst))
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn what_is_not_known_is_not_claimed() {
        assert_eq!(of_mean(&[], Over::Rounds), None);
        let one = exact(&[0.5]);
        assert_eq!(of_mean(&one, Over::ScenesAndRounds), Some(Interval::UNKNOWN));
        let single = Summary::of(&[5.0]).unwrap();
        let unknown = SceneRatio { noise: Noise::of(&single, &single, Vec::new()), ..one[0].clone() };
        assert_eq!(of_mean(std::slice::from_ref(&unknown), Over::Rounds), Some(Interval::UNKNOWN));
        assert_eq!(of_worst(&[one[0].clone(), unknown], f64::max), Some(Interval::UNKNOWN));
        assert_eq!(Interval::UNKNOWN.shown(2), "[?]");
    }

    #[test]
    fn the_worst_is_as_sure_as_its_scene() {
        let mut ratios = exact(&[0.9, 1.2]);
        assert_eq!(of_worst(&ratios, f64::max), Some(Interval { low: 1.2, high: 1.2 }));
        ratios[1].noise = Noise::Error(0.05);
        let interval = of_worst(&ratios, f64::max).unwrap();
        assert!(interval.low < 1.12 && interval.high > 1.28 && interval.high < 1.4, "{interval:?}");
        assert_eq!(of_worst(&ratios, f64::max), Some(interval), "the same again");
        assert_eq!(interval.shown(1), "[1.1, 1.3]");
    }
}
