//! The mean of paired ratios with its 95 % interval, from a few samples per scene.

use super::row::TurnRow;
use crate::bench::statistics::{Ratio, student95};

/// The logarithm of a ratio.
type Log = f64;

/// A mean of logarithms over scenes, with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairedMean {
    mean: Log,
    /// Half the 95 % interval.
    half: Log,
}

impl PairedMean {
    /// Of a builder's sessions, in one scene or several.
    pub fn of_rows<'a>(rows: impl Iterator<Item = &'a TurnRow>) -> Self {
        let mut scenes: Vec<(&str, Vec<Log>)> = Vec::new();
        for row in rows {
            let log = row.ratio.ln();
            match scenes.iter_mut().find(|(scene, _)| *scene == row.scene) {
                Some((_, logs)) => logs.push(log),
                None => scenes.push((&row.scene, vec![log])),
            }
        }
        Self::of(scenes.iter().map(|(_, logs)| &logs[..]))
    }

    /// Of each scene's samples. Scenes count alike; their samples' deviations from the scene's mean are the noise,
    /// Student's factor has their degrees of freedom. With one sample nothing is known of the noise.
    pub fn of<'a>(scenes: impl Iterator<Item = &'a [Log]>) -> Self {
        let (mut count, mut sum, mut variance, mut degrees) = (0.0, 0.0, 0.0, 0);
        for logs in scenes {
            let samples = logs.len() as f64;
            let mean = logs.iter().sum::<f64>() / samples;
            let squares: f64 = logs.iter().map(|log| (log - mean).powi(2)).sum();
            variance += squares / (samples - 1.0) / samples;
            degrees += logs.len().saturating_sub(1);
            sum += mean;
            count += 1.0;
        }
        let half = student95(degrees) * f64::sqrt(variance) / count;
        Self { mean: sum / count, half: if half.is_finite() { half } else { f64::INFINITY } }
    }

    /// Half the interval, relative to the ratio.
    pub fn half_width(&self) -> f64 {
        self.half.exp() - 1.0
    }

    /// The ratio with its interval.
    pub fn ratio(&self) -> Ratio {
        let at = |log: Log| log.exp();
        Ratio { value: at(self.mean), low: at(self.mean - self.half), high: at(self.mean + self.half) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn the_interval_is_students() {
        let logs = [0.04, 0.05, 0.06];
        let mean = PairedMean::of([&logs[..]].into_iter());
        // Deviation 0.01, three samples, two degrees of freedom.
        let half = 4.303 * 0.01 / 3f64.sqrt();
        assert!((mean.ratio().value.ln() - 0.05).abs() < 1e-12);
        assert!((mean.ratio().high.ln() - 0.05 - half).abs() < 1e-12);
        assert!((mean.half_width() - (half.exp() - 1.0)).abs() < 1e-12);
    }

    #[test]
    fn differences_between_scenes_are_no_noise() {
        let scenes = [[0.1, 0.1, 0.1], [-0.1, -0.1, -0.1]];
        let mean = PairedMean::of(scenes.iter().map(|logs| &logs[..]));
        assert_eq!((mean.ratio().value, mean.half_width()), (1.0, 0.0));
    }

    #[test]
    fn one_session_decides_nothing() {
        let ratio = PairedMean::of([&[0.5][..]].into_iter()).ratio();
        assert_eq!((ratio.low, ratio.high), (0.0, f64::INFINITY));
    }

    /// A change of 5 % under noise of 3 % a session: found in six sessions of two scenes, and none where there is none.
    #[test]
    fn a_change_is_found_and_none_where_there_is_none() {
        let mut random = SplitMix64::new(1);
        let mut noise = || (0..12).map(|_| f64::from(random.unit())).sum::<f64>() - 6.0;
        let mut inside = |change: f64| {
            (0..200)
                .filter(|_| {
                    let mut scene = || (0..6).map(|_| change + 0.03 * noise()).collect::<Vec<Log>>();
                    let (a, b) = (scene(), scene());
                    let ratio = PairedMean::of([&a[..], &b[..]].into_iter()).ratio();
                    ratio.low.ln() <= 0.0 && 0.0 <= ratio.high.ln()
                })
                .count()
        };
        assert!(inside(0.05) < 10 && inside(0.0) > 180);
    }
}
