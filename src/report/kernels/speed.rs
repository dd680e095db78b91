//! Speeds of kernels, and what is known of their noise.

use crate::bench::kernels::row::{KernelRow, SINGLE};
use crate::report::figures::interval::{LEAST_ROUNDS, Noise, Pairs, SceneRatio};

/// Our single rays.
pub(super) const OURS: &str = "phr";
/// Rays of all kinds together.
pub(super) const ALL: &str = "all";

/// How fast a kernel is over a tree.
pub(super) struct Speed {
    /// Million rays of a kind per second, or of all kinds together.
    pub mrays_s: f64,
    /// Milliseconds of each pass, in the order of the rounds; empty where the rows have none.
    passes: Vec<f64>,
    /// Standard error of the logarithm, for rows without passes.
    error: f64,
}

impl Speed {
    /// That of a builder's tree under a kernel among the rows of one scene; `None` without such rows, and where the
    /// hits of one are wrong.
    pub fn of(rows: &[&KernelRow], tree: (&str, &str, u32), kind: &str) -> Option<Self> {
        let same = |row: &&&KernelRow| {
            (row.builder.as_str(), row.kernel.as_str(), row.width) == tree
                && (kind == ALL || row.ray_kind == kind)
        };
        let (mut rays, mut seconds, mut squares) = (0.0, 0.0, 0.0);
        let mut passes: Option<Vec<f64>> = None;
        for row in rows.iter().filter(same) {
            if !row.verified {
                return None;
            }
            let of_row = row.rays as f64 / row.mrays_s;
            rays += row.rays as f64;
            seconds += of_row;
            squares += (of_row * error(row, rows)).powi(2);
            let more = row.passes();
            // Kinds may differ in their number of rounds: of those that all have.
            passes = Some(match passes {
                None => more,
                Some(sums) => sums.iter().zip(more).map(|(a, b)| a + b).collect(),
            });
        }
        let passes = passes?;
        Some(Self { mrays_s: rays / seconds, passes, error: squares.sqrt() / seconds })
    }

    /// How many times as fast as `other`: passes of a round are pairs.
    pub fn relative_to(&self, other: &Self, scene: &str) -> SceneRatio {
        let pairs: Vec<[f64; 2]> =
            other.passes.iter().zip(&self.passes).map(|(&theirs, &ours)| [theirs, ours]).collect();
        let noise = if pairs.len() >= LEAST_ROUNDS {
            Noise::Rounds(Pairs::new(pairs))
        } else {
            Noise::Error(self.error.hypot(other.error))
        };
        SceneRatio { scene: scene.into(), value: self.mrays_s / other.mrays_s, noise }
    }
}

/// The standard error of the logarithm of a row's time, worked out from the interval of its ratio to Embree's
/// single rays, whose own error is in their ratio to themselves twice; at least an even share of it. That of our
/// single rays over Embree's tree stands for rows without such a ratio. Infinite where nothing is known.
fn error(row: &KernelRow, rows: &[&KernelRow]) -> f64 {
    let like = |kernel: &str, needs_ratio: bool| {
        rows.iter().copied().find(|other| {
            (other.width, &other.ray_kind, other.kernel.as_str()) == (row.width, &row.ray_kind, kernel)
                && (other.builder == row.builder || needs_ratio && other.ratio.is_some())
        })
    };
    let of_ratio = |row: &KernelRow| Some((row.ratio_high? / row.ratio_low?).ln() / (2.0 * 1.96));
    let of = |row: &KernelRow| {
        let both = of_ratio(row)?;
        let single = of_ratio(like(SINGLE, false)?)? / 2f64.sqrt();
        Some(if row.kernel == SINGLE {
            single
        } else {
            (both * both - single * single).max(0.5 * both * both).sqrt()
        })
    };
    let of_row = of(row).or_else(|| like(OURS, true).filter(|_| row.kernel == OURS).and_then(of_ratio));
    of_row.filter(|error| error.is_finite()).unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(builder: &str, kernel: &str, half: Option<f64>) -> KernelRow {
        KernelRow {
            builder: builder.into(),
            kernel: kernel.into(),
            ray_kind: "shadow".into(),
            width: 8,
            rays: 1000,
            mrays_s: 2.0,
            verified: true,
            ratio: half.map(|_| 1.0),
            ratio_low: half.map(|half| (-1.96 * half).exp()),
            ratio_high: half.map(|half| (1.96 * half).exp()),
            ..KernelRow::default()
        }
    }

    #[test]
    fn errors_of_times_come_from_those_of_ratios() {
        // Embree's own error is 0.03, in the ratio to itself times the root of two.
        let rows = [
            row("embree-sah", SINGLE, Some(0.03 * 2f64.sqrt())),
            row("embree-sah", OURS, Some(0.05)),
            row("phr-best", OURS, None),
            row("phr-best", "phr-batch", None),
        ];
        let all: Vec<&KernelRow> = rows.iter().collect();
        let near = |value: f64, expected: f64| (value - expected).abs() < 1e-9;
        assert!(near(error(&rows[0], &all), 0.03));
        assert!(near(error(&rows[1], &all), 0.04));
        assert!(near(error(&rows[2], &all), 0.05), "that of the ratio over Embree's tree");
        assert_eq!(error(&rows[3], &all), f64::INFINITY);
        let of = |index: usize| {
            let row: &KernelRow = &rows[index];
            Speed::of(&all, (&row.builder, &row.kernel, 8), ALL).unwrap()
        };
        let Noise::Error(both) = of(1).relative_to(&of(0), "a").noise else { panic!("no passes") };
        assert!(near(both, 0.05));
    }

    #[test]
    fn passes_of_a_round_are_pairs() {
        let with = |kernel: &str, kind: &str, passes: &str| KernelRow {
            ray_kind: kind.into(),
            pass_ms: passes.into(),
            ..row("embree-sah", kernel, None)
        };
        // Both drift alike: their ratio has no noise, whatever happens in rounds that not all kinds have.
        let rows = [
            with(SINGLE, "shadow", "1 2 4"),
            with(SINGLE, "bounce", "1 2 4 4"),
            with(OURS, "shadow", "2 4 8"),
            with(OURS, "bounce", "2 4 8 9"),
        ];
        let all: Vec<&KernelRow> = rows.iter().collect();
        let of = |kernel| Speed::of(&all, ("embree-sah", kernel, 8), ALL).unwrap();
        let ratio = of(OURS).relative_to(&of(SINGLE), "a");
        let interval = ratio.interval();
        assert!(matches!(ratio.noise, Noise::Rounds(_)) && interval.high - interval.low < 1e-9, "{ratio:?}");
    }
}
