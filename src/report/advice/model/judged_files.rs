//! The table of how good advice in files is, measured most often, by a run over the same scenes.

use super::judge::{judge, one_round};
use super::judged::{Judged, misses, table};
use super::observed::{Observed, observed};
use crate::bench::quick::line::TotalTime;
use crate::bench::row::Row;
use crate::report::advice::rows::AdviceRow;

/// The table for some files of advice, by the total times of a run.
///
/// # Errors
/// Advice for a scene that the run does not have, or for none of its trees, in one line.
pub fn page(run: &[Row], advice: &[Vec<AdviceRow>]) -> Result<String, String> {
    let run = observed(run);
    let trees =
        run.first().map(|scene| scene.trees.clone()).ok_or("no scene has lbvh under embree-grafted")?;
    let (mut outcomes, mut noise) = (Vec::new(), Vec::new());
    for rows in advice {
        let name = rows.first().map(|row| row.scene.as_str()).unwrap_or_default();
        let scene = run.iter().find(|scene| scene.scene == name);
        let scene = scene.ok_or_else(|| format!("the run has no scene {name}, for which there is advice"))?;
        let lines = lines(scene, rows);
        if !lines.iter().any(|line| line.at(0.0).is_finite()) {
            return Err(format!("the advice for {name} has none of the run's trees"));
        }
        outcomes.extend(judge(scene, &lines));
        noise.extend(one_round(std::slice::from_ref(scene)).unwrap_or_default());
    }
    let mut about = format!(
        "Share of {} scenes in which the advised tree takes at most 5 % more time in all than the best by the run's medians, and \
         the mean loss, among the {} trees that the run has.",
        advice.len(),
        trees.len()
    );
    let mut all = vec![Judged { name: "advice", trees: trees.clone(), outcomes }];
    if !noise.is_empty() {
        all.push(Judged { name: "one round", trees, outcomes: noise });
        about += " one round: the run's first round in place of the advice, judged by its later ones, which shows the noise.";
    }
    about.push('\n');
    Ok(table(&all) + "\n" + &about + &misses(&all[0]))
}

/// The advice's line of each tree of the scene; an endless time where it has none.
fn lines(scene: &Observed, rows: &[AdviceRow]) -> Vec<TotalTime> {
    let of = |tree: &(String, u32)| {
        let row = rows.iter().find(|row| (&row.builder, row.width) == (&tree.0, tree.1));
        row.and_then(AdviceRow::line).unwrap_or(TotalTime::exact(f64::INFINITY, f64::INFINITY))
    };
    scene.trees.iter().map(of).collect()
}
