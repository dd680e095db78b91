//! How often even a perfect adviser would be called wrong by a judge of a few noisy rounds.

use super::observed::Observed;
use crate::bench::quick::line::{TotalTime, least_at};
use crate::bench::quick::survey::BUDGETS;
use crate::bench::statistics::median;
use crate::random::SplitMix64;

/// Judges drawn in each scene.
const DRAWS: usize = 200;

/// The share of pairs of scene and number of rays in which the best tree is within `factor` of what a judge takes for
/// the best. The medians of all rounds stand for the truth; a judge has the medians of as many rounds, drawn from them
/// anew, with replacement. As medians are further apart than what they stand for, by their own noise, the share is
/// rather too high. `None` where a scene has fewer than three rounds.
pub fn perfect_share(scenes: &[&Observed], factor: f64) -> Option<f64> {
    let mut random = SplitMix64::new(1);
    let (mut within, mut all) = (0usize, 0usize);
    for scene in scenes {
        let rounds = &scene.by_round;
        if rounds.len() < 3 {
            return None;
        }
        let truth = medians(rounds)?;
        let best = BUDGETS.map(|rays| least_at(&truth, rays).unwrap_or_default());
        for _ in 0..DRAWS {
            let drawn: Vec<&Vec<TotalTime>> =
                rounds.iter().map(|_| &rounds[random.below(rounds.len())]).collect();
            let judge = medians(&drawn)?;
            for (rays, best) in BUDGETS.iter().zip(best) {
                let least = judge.iter().map(|line| line.at(*rays)).fold(f64::INFINITY, f64::min);
                within += usize::from(judge[best].at(*rays) <= factor * least);
                all += 1;
            }
        }
    }
    (all > 0).then(|| within as f64 / all as f64)
}

/// The median of each figure of each tree over some rounds; `None` without any.
fn medians<T: AsRef<[TotalTime]>>(rounds: &[T]) -> Option<Vec<TotalTime>> {
    let trees = rounds.first()?.as_ref().len();
    let of = |tree: usize, figure: fn(&TotalTime) -> f64| {
        median(&rounds.iter().filter_map(|lines| lines.as_ref().get(tree)).map(figure).collect::<Vec<_>>())
    };
    (0..trees).map(|tree| Some(TotalTime::exact(of(tree, build)?, of(tree, ray)?))).collect()
}

fn build(line: &TotalTime) -> f64 {
    line.build_ms.value
}

fn ray(line: &TotalTime) -> f64 {
    line.ns_per_ray.value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::advice::model::facts::SceneFacts;

    /// A scene of two trees, `a` and `b`, with builds of so many ms in its rounds; rays take ten times as many ns.
    fn scene(rounds: &[[f64; 2]]) -> Observed {
        let by_round: Vec<Vec<TotalTime>> =
            rounds.iter().map(|round| round.map(|ms| TotalTime::exact(ms, 10.0 * ms)).to_vec()).collect();
        Observed {
            scene: "hall".into(),
            facts: SceneFacts { triangles: 1e5, sah: 40.0, epo: 5.0, leaf_fill: 0.8 },
            trees: ["a", "b"].map(|builder| (builder.to_owned(), 4)).to_vec(),
            lines: medians(&by_round).unwrap(),
            by_round,
        }
    }

    #[test]
    fn only_noise_calls_a_perfect_adviser_wrong() {
        let quiet = scene(&[[10.0, 11.0], [10.0, 11.0], [10.0, 11.0]]);
        assert_eq!(perfect_share(&[&quiet], 1.05), Some(1.0));
        // Which is the better one is chance.
        let noisy = scene(&[[10.0, 12.0], [12.0, 10.0], [10.0, 12.0], [12.0, 10.1], [11.0, 11.0]]);
        let share = perfect_share(&[&noisy], 1.05).unwrap();
        assert!(share > 0.4 && share < 0.95, "{share}");
        assert_eq!(perfect_share(&[&scene(&[[1.0, 2.0], [1.0, 2.0]])], 1.05), None);
        assert_eq!(perfect_share(&[], 1.05), None);
    }
}
