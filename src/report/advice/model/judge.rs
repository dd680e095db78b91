//! How good advice is: for each scene and number of rays, what the advised tree takes in all relative to the best.

use super::Model;
use super::observed::Observed;
use crate::bench::quick::line::{TotalTime, least_at};
use crate::bench::quick::survey::BUDGETS;
use crate::bench::statistics::Ratio;
use crate::bench::turns::paired::PairedMean;

/// Advice for one scene and number of rays.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The scene.
    pub scene: String,
    /// Number of rays.
    pub rays: f64,
    /// Index of the advised tree.
    pub advised: usize,
    /// Index of the best.
    pub best: usize,
    /// Total time of the advised tree relative to the best: at least 1.
    pub ratio: f64,
    /// The same in each round.
    pub by_round: Vec<f64>,
}

impl Outcome {
    /// Student's 95 % interval of the ratio over the rounds, about their mean; `None` below three rounds.
    pub fn over_rounds(&self) -> Option<Ratio> {
        let logs: Vec<f64> = self.by_round.iter().map(|ratio| ratio.ln()).collect();
        (logs.len() >= 3).then(|| PairedMean::of(std::iter::once(&logs[..])).ratio())
    }
}

/// Judges advice by `lines` for a scene.
pub fn judge(scene: &Observed, lines: &[TotalTime]) -> Vec<Outcome> {
    let of = |&rays: &f64| {
        let (advised, best) = (least_at(lines, rays)?, scene.best(rays));
        let by_round =
            scene.by_round.iter().map(|lines| lines[advised].at(rays) / lines[best].at(rays)).collect();
        let ratio = scene.ratio(advised, rays);
        Some(Outcome { scene: scene.scene.clone(), rays, advised, best, ratio, by_round })
    };
    BUDGETS.iter().filter_map(of).collect()
}

/// The mean over the rounds of the logarithm of the advised tree's ratio to the one that is the best by all other
/// rounds, which does not take the luck of a round for merit; `None` below three rounds.
pub fn fair_loss(by_round: &[Vec<TotalTime>], advised: usize, rays: f64) -> Option<f64> {
    if by_round.len() < 3 {
        return None;
    }
    let of = |(round, lines): (usize, &Vec<TotalTime>)| {
        let others = |tree: usize| {
            by_round.iter().enumerate().filter(move |(i, _)| *i != round).map(move |(_, it)| it[tree])
        };
        let means: Vec<TotalTime> =
            (0..lines.len()).filter_map(|tree| TotalTime::mean(others(tree))).collect();
        Some((lines[advised].at(rays) / lines[least_at(&means, rays)?].at(rays)).ln())
    };
    let logs: Vec<f64> = by_round.iter().enumerate().map(of).collect::<Option<_>>()?;
    Some(logs.iter().sum::<f64>() / logs.len() as f64)
}

/// Judges each scene by the model that `fit` makes of the others.
pub fn leave_one_out(scenes: &[Observed], fit: &dyn Fn(&[&Observed]) -> Model) -> Vec<Outcome> {
    let others = |out: usize| -> Vec<&Observed> {
        scenes.iter().enumerate().filter(|(i, _)| *i != out).map(|(_, scene)| scene).collect()
    };
    let of = |(out, scene): (usize, &Observed)| judge(scene, &fit(&others(out)).lines(&scene.facts));
    scenes.iter().enumerate().flat_map(of).collect()
}

/// Judges a measurement of one round by the rounds after it; `None` where a scene has no rounds.
pub fn one_round(scenes: &[Observed]) -> Option<Vec<Outcome>> {
    let of = |scene: &Observed| {
        let (first, later) = scene.by_round.split_first()?;
        let lines = (0..first.len()).map(|tree| TotalTime::mean(later.iter().map(|lines| lines[tree])));
        let lines = lines.collect::<Option<_>>()?;
        Some(judge(&Observed { lines, by_round: later.to_vec(), ..scene.clone() }, first))
    };
    let judged: Option<Vec<Vec<Outcome>>> = scenes.iter().map(of).collect();
    Some(judged?.concat())
}

/// The mean loss: the mean of the ratios' logarithms.
pub fn loss(outcomes: &[Outcome]) -> f64 {
    outcomes.iter().map(|outcome| outcome.ratio.ln()).sum::<f64>() / outcomes.len().max(1) as f64
}

/// The share of outcomes within `factor` of the best.
pub fn share_within(outcomes: &[Outcome], factor: f64) -> f64 {
    outcomes.iter().filter(|outcome| outcome.ratio <= factor).count() as f64 / outcomes.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn luck_is_no_merit() {
        let rounds = |times: &[[f64; 2]]| -> Vec<Vec<TotalTime>> {
            times.iter().map(|round| round.iter().map(|&ms| TotalTime::exact(ms, 0.0)).collect()).collect()
        };
        // Who is lucky in a round loses the others.
        let equal = rounds(&[[1.0, 2.0], [2.0, 1.0], [1.0, 2.0], [2.0, 1.0]]);
        assert!(fair_loss(&equal, 0, 1e6).unwrap() <= 0.0);
        let slower = rounds(&[[1.1, 1.0], [1.11, 1.0], [1.09, 1.0]]);
        assert!((fair_loss(&slower, 0, 1e6).unwrap() - 1.1f64.ln()).abs() < 1e-3);
        assert_eq!(fair_loss(&slower[..2], 0, 1e6), None);
    }

    #[test]
    fn noise_makes_no_advice_wrong() {
        let of = |by_round: &[f64]| Outcome {
            scene: "hall".into(),
            rays: 1e6,
            advised: 0,
            best: 1,
            ratio: 1.1,
            by_round: by_round.to_vec(),
        };
        let Ratio { value, low, high } = of(&[1.1, 1.11, 1.09]).over_rounds().unwrap();
        assert!(1.05 < low && low < value && value < high && high < 1.15, "{low} {high}");
        assert!(of(&[1.3, 1.1, 0.9]).over_rounds().is_some_and(|it| it.low < 1.05 && it.high > 1.05));
        assert_eq!(of(&[1.1, 1.1]).over_rounds(), None);
    }
}
