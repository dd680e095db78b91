//! How good advice is: for each scene and number of rays, what the advised tree takes in all relative to the best.

use super::Model;
use super::observed::Observed;
use crate::bench::quick::line::{TotalTime, least_at};
use crate::bench::quick::survey::BUDGETS;

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
}

/// Judges advice by `lines` for a scene.
pub fn judge(scene: &Observed, lines: &[TotalTime]) -> Vec<Outcome> {
    let of = |&rays: &f64| {
        let (advised, best) = (least_at(lines, rays)?, scene.best(rays));
        Some(Outcome { scene: scene.scene.clone(), rays, advised, best, ratio: scene.ratio(advised, rays) })
    };
    BUDGETS.iter().filter_map(of).collect()
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
        let [first, later] = scene.by_round.as_ref()?;
        Some(judge(&Observed { lines: later.clone(), ..scene.clone() }, first))
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
