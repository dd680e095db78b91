//! What rounds tell of a ratio's noise.

use crate::bench::statistics::{NORMAL95, Summary, student95};
use crate::random::SplitMix64;

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
                Self::Error(a.cautious_error().hypot(b.cautious_error()) / NORMAL95)
            }
            LEAST_ROUNDS.. => Self::Rounds(Pairs::new(pairs)),
            _ => Self::Error(f64::INFINITY),
        }
    }

    /// The logarithm of a factor by which the ratio might have come out otherwise; what rounds tell `student` times.
    pub(super) fn draw(&self, random: &mut SplitMix64, scratch: &mut Vec<f64>, student: f64) -> f64 {
        match self {
            Self::Error(error) if *error == 0.0 => 0.0,
            Self::Error(error) => error * normal(random),
            Self::Rounds(pairs) => student * pairs.draw(random, scratch),
        }
    }
}

/// Two builders' times by round, two rounds at least.
#[derive(Clone, Debug, PartialEq)]
pub struct Pairs {
    pub(super) pairs: Vec<[f64; 2]>,
    pub(super) ratio: f64,
}

impl Pairs {
    /// Of `pairs`, two at least.
    pub fn new(pairs: Vec<[f64; 2]>) -> Self {
        let of = |side: usize| median_of(&mut pairs.iter().map(|pair| pair[side]).collect::<Vec<_>>());
        let ratio = of(0) / of(1);
        Self { pairs, ratio }
    }

    /// The logarithm of the ratio of the medians of as many rounds, drawn with replacement, relative to that of all.
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
        (above / below / self.ratio).ln() * (count as f64 / (count as f64 - 1.0)).sqrt()
    }
}

/// The median of some values, which it sorts.
fn median_of(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
}

/// Normally distributed, of variance 1 (Box and Muller).
pub(super) fn normal(random: &mut SplitMix64) -> f64 {
    let mut unit = || (random.next_u64() >> 11) as f64 * 2f64.powi(-53);
    let (radius, angle) = ((-2.0 * (1.0 - unit()).ln()).sqrt(), std::f64::consts::TAU * unit());
    radius * angle.cos()
}

/// By how much deviations of `count` scenes or rounds drawn again are to be enlarged: those of few from their own mean
/// are too small, and their size is known from these few.
pub fn wider(count: usize) -> f64 {
    let others = count as f64 - 1.0;
    (count as f64 / others).sqrt() * student95(count - 1) / NORMAL95
}

/// By how much deviations of rounds are to be enlarged, since their size is known from so few: Student's factor by the
/// normal one, of the degrees of freedom that all scenes have together.
pub(super) fn student<'a>(of_scenes: impl Iterator<Item = &'a Noise>) -> f64 {
    let degrees = of_scenes.map(|noise| match noise {
        Noise::Rounds(pairs) => pairs.pairs.len() - 1,
        // The error is Student's already.
        Noise::Error(_) => 0,
    });
    match degrees.sum() {
        0 => 1.0,
        degrees => student95(degrees) / NORMAL95,
    }
}
