//! Robust statistics of few samples: median and median absolute deviation, the interval of a ratio, means
//! of ratios over scenes.

#![allow(clippy::indexing_slicing, reason = "ranks of a sorted list, within its length")]

use serde::{Deserialize, Serialize};

/// What is kept of a list of samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Number of samples, at least 1.
    pub count: usize,
    /// The middle sample, or the mean of the middle two.
    pub median: f64,
    /// Median of the distances from the median.
    pub mad: f64,
    /// Least sample.
    pub min: f64,
    /// Greatest sample.
    pub max: f64,
}

impl Summary {
    /// Summarises `samples`; `None` if there are none or one is not finite.
    pub fn of(samples: &[f64]) -> Option<Self> {
        if samples.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let median = median(samples)?;
        let distances: Vec<f64> = samples.iter().map(|x| (x - median).abs()).collect();
        Some(Self {
            count: samples.len(),
            median,
            mad: self::median(&distances)?,
            min: samples.iter().copied().fold(f64::INFINITY, f64::min),
            max: samples.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        })
    }

    /// Half the width of the 95 % interval of the median, relative to it: the standard error of a median
    /// of normal noise, 1.2533 sigma / sqrt(n) with sigma = 1.4826 MAD, times Student's factor for so few
    /// samples. Infinite for one sample, of whose spread nothing is known.
    pub fn relative_error(&self) -> f64 {
        if self.count < 2 || self.median == 0.0 {
            return f64::INFINITY;
        }
        let sigma = 1.4826 * self.mad;
        student95(self.count - 1) * 1.2533 * sigma / (self.count as f64).sqrt() / self.median.abs()
    }

    /// The same, but of few samples at least half of what lies between the least and the greatest: two of three may be
    /// alike by chance.
    pub fn cautious_error(&self) -> f64 {
        let range = if self.count < Ratio::FEW { (self.max - self.min) / self.median.abs() } else { 0.0 };
        self.relative_error().max(0.5 * range)
    }
}

/// The middle of `samples`, or `None` if there are none.
pub fn median(samples: &[f64]) -> Option<f64> {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        n if n % 2 == 1 => Some(sorted[middle]),
        _ => Some(0.5 * (sorted[middle - 1] + sorted[middle])),
    }
}

/// Student's two-sided 95 % quantile.
pub fn student95(degrees: usize) -> f64 {
    const TABLE: [f64; 10] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228];
    match degrees {
        0 => f64::INFINITY,
        1..=10 => TABLE[degrees - 1],
        11..=20 => 2.2,
        21..=60 => 2.06,
        _ => NORMAL95,
    }
}

/// The normal distribution's two-sided 95 % quantile.
pub const NORMAL95: f64 = 1.96;

/// A ratio of two medians with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ratio {
    /// The ratio.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Ratio {
    /// `a / b`, the relative errors of both added in quadrature. Needs the summaries only, as they stand
    /// in the CSV.
    pub fn propagated(a: &Summary, b: &Summary) -> Self {
        let value = a.median / b.median;
        let error = a.relative_error().hypot(b.relative_error());
        Self { value, low: value * (1.0 - error).max(0.0), high: value * (1.0 + error) }
    }

    /// `a / b` by bootstrap: both lists resampled 2000 times with a generator seeded with `seed`; the
    /// interval holds the middle 95 % of the ratios of medians. `None` if a list is empty.
    pub fn bootstrap(a: &[f64], b: &[f64], seed: u64) -> Option<Self> {
        const RESAMPLES: usize = 2000;
        let value = median(a)? / median(b)?;
        let mut random = crate::random::SplitMix64::new(seed);
        let mut ratios = Vec::with_capacity(RESAMPLES);
        let mut resampled = |samples: &[f64]| {
            let drawn: Vec<f64> = samples.iter().map(|_| samples[random.below(samples.len())]).collect();
            median(&drawn)
        };
        for _ in 0..RESAMPLES {
            ratios.push(resampled(a)? / resampled(b)?);
        }
        ratios.sort_by(f64::total_cmp);
        Some(Self { value, low: ratios[RESAMPLES / 40], high: ratios[RESAMPLES - 1 - RESAMPLES / 40] })
    }
}

impl Ratio {
    /// Samples below which a bootstrap is too sure of itself: few samples can be redrawn in few ways only.
    const FEW: usize = 10;

    /// `a / b` by bootstrap where samples are known, widened to the propagated interval where they are few;
    /// by propagation alone where they are not known.
    pub fn cautious(a: (&Summary, &[f64]), b: (&Summary, &[f64]), seed: u64) -> Self {
        let propagated = Self::propagated(a.0, b.0);
        match Self::bootstrap(a.1, b.1, seed) {
            Some(drawn) if a.1.len().min(b.1.len()) < Self::FEW => {
                Self { low: drawn.low.min(propagated.low), high: drawn.high.max(propagated.high), ..drawn }
            }
            Some(drawn) => drawn,
            None => propagated,
        }
    }
}

/// The geometric mean of positive values, the right mean for ratios; `None` for none.
pub fn geometric_mean(values: &[f64]) -> Option<f64> {
    let usable = !values.is_empty() && values.iter().all(|&x| x > 0.0 && x.is_finite());
    usable.then(|| (values.iter().map(|x| x.ln()).sum::<f64>() / values.len() as f64).exp())
}

/// The arithmetic mean, as in the paper's Figure 6; `None` for none.
pub fn arithmetic_mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Rounded to six significant digits: more would be noise in a diff.
pub fn figures(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_and_deviations() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0]), Some(3.0));
        assert_eq!(median(&[4.0, 1.0, 3.0]), Some(3.0));
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), Some(2.5));
        let summary = Summary::of(&[1.0, 1.0, 2.0, 2.0, 4.0, 6.0, 9.0]).unwrap();
        assert_eq!(summary, Summary { count: 7, median: 2.0, mad: 1.0, min: 1.0, max: 9.0 });
        assert_eq!(Summary::of(&[]), None);
        assert_eq!(Summary::of(&[1.0, f64::NAN]), None);
    }

    #[test]
    fn one_sample_decides_nothing() {
        let one = Summary::of(&[5.0]).unwrap();
        let many = Summary::of(&[10.0, 10.1, 9.9]).unwrap();
        let ratio = Ratio::propagated(&one, &many);
        assert_eq!((ratio.value, ratio.low, ratio.high), (0.5, 0.0, f64::INFINITY));
    }

    #[test]
    fn propagated_intervals_shrink_with_samples_and_grow_with_spread() {
        let wide = |n: usize, spread: f64| {
            let samples: Vec<f64> = (0..n).map(|i| 10.0 + spread * ((i % 3) as f64 - 1.0)).collect();
            let summary = Summary::of(&samples).unwrap();
            let ratio = Ratio::propagated(&summary, &summary);
            assert!(ratio.low <= 1.0 && ratio.high >= 1.0);
            ratio.high - ratio.low
        };
        assert!(wide(3, 0.1) > wide(9, 0.1));
        assert!(wide(9, 1.0) > wide(9, 0.1));
        // By hand: n = 3, MAD = 0.1: 4.303 * 1.2533 * 0.14826 / sqrt(3) / 10 = 0.04616, twice in quadrature.
        assert!((wide(3, 0.1) - 2.0 * 0.04616 * 2f64.sqrt()).abs() < 1e-4);
    }

    #[test]
    fn bootstrap_holds_the_ratio_and_repeats_itself() {
        let a = [10.0, 10.2, 9.9, 10.1, 10.05];
        let b = [5.0, 5.1, 4.9, 5.05, 4.95];
        let ratio = Ratio::bootstrap(&a, &b, 7).unwrap();
        assert!((ratio.value - 2.01).abs() < 1e-9);
        assert!(ratio.low <= ratio.value && ratio.value <= ratio.high);
        assert!(ratio.low > 1.9 && ratio.high < 2.1);
        assert_eq!(Ratio::bootstrap(&a, &b, 7), Some(ratio));
        assert_eq!(Ratio::bootstrap(&a, &[], 7), None);
        let certain = Ratio::bootstrap(&[2.0; 4], &[1.0; 4], 1).unwrap();
        assert_eq!((certain.low, certain.high), (2.0, 2.0));
    }

    #[test]
    fn cautious_intervals_are_never_narrower_for_few_samples() {
        // Two of three samples alike: the deviation is nothing, the bootstrap knows of the third.
        let (a, b) = ([10.0, 10.0, 12.0], [10.0, 10.0, 10.0]);
        let of = |samples: &[f64]| Summary::of(samples).unwrap();
        let cautious = Ratio::cautious((&of(&a), &a), (&of(&b), &b), 1);
        assert_eq!((cautious.low, cautious.value, cautious.high), (1.0, 1.0, 1.2));
        // One sample can only be redrawn as itself; nothing is known of its spread.
        let one = Ratio::cautious((&of(&[10.0]), &[10.0]), (&of(&b), &b), 1);
        assert_eq!((one.low, one.high), (0.0, f64::INFINITY));
        let unknown = Ratio::cautious((&of(&a), &[]), (&of(&b), &[]), 1);
        assert_eq!(unknown, Ratio::propagated(&of(&a), &of(&b)));
    }

    #[test]
    fn means_of_ratios() {
        assert_eq!(arithmetic_mean(&[1.0, 4.0]), Some(2.5));
        assert!((geometric_mean(&[1.0, 4.0]).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(geometric_mean(&[]), None);
        assert_eq!(geometric_mean(&[1.0, 0.0]), None);
        assert_eq!(arithmetic_mean(&[]), None);
    }

    #[test]
    fn figures_have_six_digits() {
        assert_eq!(figures(1_234.567_89), 1234.57);
        assert_eq!(figures(0.001_234_567_89), 0.001_234_57);
        assert_eq!(figures(0.0), 0.0);
        assert!(figures(f64::NAN).is_nan());
    }
}
