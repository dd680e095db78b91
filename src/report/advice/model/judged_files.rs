//! The table of how good advice in files is, measured most often, by a run over the same scenes, which has to have
//! every tree that the advice names as the best.

use super::judge::{Outcome, fair_loss, judge, one_round};
use super::judged::{Judged, RIGHT, misses, table};
use super::observed::{Observed, observed};
use super::perfect::perfect_share;
use crate::bench::quick::line::{TotalTime, least_at};
use crate::bench::quick::survey::BUDGETS;
use crate::bench::row::Row;
use crate::bench::statistics::{Ratio, arithmetic_mean};
use crate::report::advice::rays_in_words;
use crate::report::advice::rows::{AdviceRow, lines};
use crate::report::figures::interval::{Noise, SceneRatio, of_arithmetic_mean};
use crate::report::figures::tree_name;

/// The table for some files of advice, by the total times of a run.
///
/// # Errors
/// Advice for a scene or a tree that the run does not have, in one line.
pub fn page(run: &[Row], advice: &[Vec<AdviceRow>]) -> Result<String, String> {
    let run = observed(run);
    let trees =
        run.first().map(|scene| scene.trees.clone()).ok_or("no scene has lbvh under embree-grafted")?;
    let (mut outcomes, mut noise, mut losses) = (Vec::new(), Vec::new(), Vec::new());
    let mut of_best = Vec::new();
    let mut scenes = Vec::new();
    for rows in advice {
        let name = rows.first().map(|row| row.scene.as_str()).unwrap_or_default();
        let scene = run.iter().find(|scene| scene.scene == name);
        let scene = scene.ok_or_else(|| {
            format!("the run has no scene {name}, for which there is advice; add it to the run, or remove the advice")
        })?;
        all_are_measured(scene, rows)?;
        let judged = judge(scene, &lines_of(scene, rows));
        scenes.push(scene);
        losses.extend(judged.iter().map(|outcome| fair_loss(&scene.by_round, outcome.advised, outcome.rays)));
        of_best.extend(judged.iter().map(|outcome| fair_loss(&scene.by_round, outcome.best, outcome.rays)));
        outcomes.extend(judged);
        noise.extend(one_round(std::slice::from_ref(scene)).unwrap_or_default());
    }
    let mut about = format!(
        "Share of {} scenes in which the advised tree takes at most 5 % more time in all than the best by the run's \
         medians, and the mean loss, among the {} trees that the run has.",
        advice.len(),
        trees.len()
    );
    let over_rounds: Option<Vec<Ratio>> = outcomes.iter().map(Outcome::over_rounds).collect();
    if let Some(ratios) = over_rounds {
        let count = |is_one: fn(&Ratio) -> bool| ratios.iter().filter(|ratio| is_one(ratio)).count();
        let (within, above) = (count(|ratio| ratio.high <= RIGHT), count(|ratio| ratio.low > RIGHT));
        let all = ratios.len();
        about += &format!(
            " Of {all} pairs of scene and number of rays it is surely within 5 % in {within}, surely beyond in {above}, by the \
             whole 95 % interval over the run's rounds; {} are undecided.",
            all - within - above
        );
    }
    if let Some(share) = perfect_share(&scenes, RIGHT) {
        about += &format!(
            " A perfect adviser would on average be called right in {:.0} %: so often the best tree stays within 5 % of \
             the best when as many rounds are drawn from these anew, with replacement.",
            100.0 * share
        );
    }
    let all_known = |losses: Vec<Option<f64>>| losses.into_iter().collect::<Option<Vec<f64>>>();
    if let Some((losses, of_best)) = all_known(losses).zip(all_known(of_best)) {
        let percent =
            |losses: &[f64]| 100.0 * ((losses.iter().sum::<f64>() / losses.len() as f64).exp() - 1.0);
        let (mean, of_best) = (percent(&losses), percent(&of_best));
        let shares = fair_shares(&scenes, &losses);
        let share = 100.0
            * arithmetic_mean(&shares.iter().map(|scene| scene.value).collect::<Vec<_>>()).unwrap_or(0.0);
        let interval = of_arithmetic_mean(&shares).filter(|interval| interval.high.is_finite());
        let interval = interval.map_or_else(String::new, |it| {
            format!(" [{:.0}, {:.0}] (95 % over scenes)", 100.0 * it.low.max(0.0), 100.0 * it.high.min(1.0))
        });
        about += &format!(
            " The best of many noisy figures looks better than it is: in rounds by which it was not chosen, the advice loses \
             {mean:.1} % against it in the mean, and is within 5 % in {share:.0} %{interval} of the pairs. \
             That mean flatters, since what it is beside was chosen by fewer rounds: the best tree by the medians of all \
             loses {of_best:.1} % so."
        );
    }
    let mut all = vec![Judged { name: "advice", trees: trees.clone(), outcomes }];
    if !noise.is_empty() {
        all.push(Judged { name: "one round", trees, outcomes: noise });
        about += " one round: the run's first round in place of the advice, judged by its later ones, which shows the noise.";
    }
    about.push('\n');
    Ok(table(&all) + "\n" + &about + &misses(&all[0]))
}

/// Of each scene the share of pairs in which the fair loss is within 5 %; the losses stand scene by scene.
fn fair_shares(scenes: &[&Observed], losses: &[f64]) -> Vec<SceneRatio> {
    let of = |(scene, losses): (&&Observed, &[f64])| {
        let right = losses.iter().filter(|loss| **loss <= RIGHT.ln()).count();
        let value = right as f64 / losses.len() as f64;
        SceneRatio { scene: scene.scene.clone(), value, noise: Noise::NONE }
    };
    scenes.iter().zip(losses.chunks(BUDGETS.len())).map(of).collect()
}

/// Whether the run has every tree that the advice takes for the best.
fn all_are_measured(scene: &Observed, rows: &[AdviceRow]) -> Result<(), String> {
    let (known, lines): (Vec<&AdviceRow>, Vec<TotalTime>) =
        rows.iter().zip(lines(rows)).filter_map(|(row, line)| Some((row, line?))).unzip();
    for rays in BUDGETS {
        let best =
            least_at(&lines, rays).ok_or_else(|| format!("the advice for {} has no tree", scene.scene))?;
        let AdviceRow { builder, width, .. } = known[best];
        if !scene.trees.contains(&(builder.clone(), *width)) {
            let (tree, rays) = (tree_name((builder, *width)), rays_in_words(rays));
            return Err(format!(
                "the advice for {} is {tree} for {rays} rays, which the run has not in every scene; bench {builder} too",
                scene.scene
            ));
        }
    }
    Ok(())
}

/// The advice's line of each tree of the scene; an endless time where it has none.
fn lines_of(scene: &Observed, rows: &[AdviceRow]) -> Vec<TotalTime> {
    let lines = lines(rows);
    let of = |tree: &(String, u32)| {
        let place = rows.iter().position(|row| (&row.builder, row.width) == (&tree.0, tree.1));
        place.and_then(|place| lines[place]).unwrap_or(TotalTime::exact(f64::INFINITY, f64::INFINITY))
    };
    scene.trees.iter().map(of).collect()
}
