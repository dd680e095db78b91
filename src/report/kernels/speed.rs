//! Speeds of kernels, and what is known of their noise.

use crate::bench::kernels::row::KernelRow;
use crate::report::figures::interval::{LEAST_ROUNDS, Noise, Pairs, SceneRatio};

/// Our single rays.
pub(super) const OURS: &str = "phr";
/// Rays of all kinds together.
pub(super) const ALL: &str = "all";

/// How fast a kernel is over a tree.
pub(super) struct Speed {
    /// Million rays of a kind per second, or of all kinds together.
    pub mrays_s: f64,
    /// Milliseconds of each pass, in the order of the rounds.
    passes: Vec<f64>,
}

impl Speed {
    /// That of a builder's tree under a kernel among the rows of one scene; `None` without such rows, and where the
    /// hits of one are wrong.
    pub fn of(rows: &[&KernelRow], tree: (&str, &str, u32), kind: &str) -> Option<Self> {
        let same = |row: &&&KernelRow| {
            (row.builder.as_str(), row.kernel.as_str(), row.width) == tree
                && (kind == ALL || row.ray_kind == kind)
        };
        let (mut rays, mut seconds) = (0.0, 0.0);
        let mut passes: Option<Vec<f64>> = None;
        for row in rows.iter().filter(same) {
            if !row.verified {
                return None;
            }
            rays += row.rays as f64;
            seconds += row.rays as f64 / row.mrays_s;
            let more = row.passes();
            // Kinds may differ in their number of rounds: of those that all have.
            passes = Some(match passes {
                None => more,
                Some(sums) => sums.iter().zip(more).map(|(a, b)| a + b).collect(),
            });
        }
        Some(Self { mrays_s: rays / seconds, passes: passes? })
    }

    /// How many times as fast as `other`: passes of a round are pairs; fewer than [`LEAST_ROUNDS`] tell nothing.
    pub fn relative_to(&self, other: &Self, scene: &str) -> SceneRatio {
        let pairs: Vec<[f64; 2]> =
            other.passes.iter().zip(&self.passes).map(|(&theirs, &ours)| [theirs, ours]).collect();
        let noise = if pairs.len() >= LEAST_ROUNDS {
            Noise::Rounds(Pairs::new(pairs))
        } else {
            Noise::Error(f64::INFINITY)
        };
        SceneRatio { scene: scene.into(), value: self.mrays_s / other.mrays_s, noise }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::kernels::row::SINGLE;

    #[test]
    fn passes_of_a_round_are_pairs() {
        let with = |kernel: &str, kind: &str, passes: &str| KernelRow {
            builder: "embree-sah".into(),
            kernel: kernel.into(),
            ray_kind: kind.into(),
            width: 8,
            rays: 1000,
            mrays_s: 2.0,
            verified: true,
            pass_ms: passes.into(),
            ..KernelRow::default()
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
