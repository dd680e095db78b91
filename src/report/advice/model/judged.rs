//! The table of how good instant advice is: scenes left out of the open run, and withheld scenes that no model has
//! seen.

use super::choose::{Choice, choose};
use super::fit::weights;
use super::judge::{Outcome, judge, leave_one_out, loss, one_round, share_within};
use super::observed::{Observed, TreeName, observed};
use crate::bench::quick::survey::BUDGETS;
use crate::bench::row::Row;
use crate::report::advice::rays_in_words;
use crate::report::figures::tree_name;
use crate::report::grid::Grid;

/// Advice this near to the best counts as right.
pub(super) const RIGHT: f64 = 1.05;

/// The judged advice of one set of scenes.
pub(super) struct Judged {
    pub(super) name: &'static str,
    pub(super) trees: Vec<TreeName>,
    pub(super) outcomes: Vec<Outcome>,
}

/// The tables for an open run and, where there is one, a run over withheld scenes.
///
/// # Errors
/// Too few scenes, in one line.
pub fn page(open: &[Row], withheld: Option<&[Row]>) -> Result<String, String> {
    let open = observed(open);
    if open.len() < 3 {
        return Err(format!("{} scenes with lbvh under embree-grafted; 3 are needed", open.len()));
    }
    let trees = open[0].trees.clone();
    let choice = choose(&open);
    let by = |choice: &Choice| {
        let Choice { facts, ridge } = choice.clone();
        move |others: &[&Observed]| weights(others, &facts, ridge)
    };
    let same = Choice { facts: Vec::new(), ridge: choice.ridge };
    let mut all = vec![
        Judged { name: "model", trees: trees.clone(), outcomes: leave_one_out(&open, &by(&choice)) },
        Judged { name: "same for all", trees: trees.clone(), outcomes: leave_one_out(&open, &by(&same)) },
    ];
    if let Some(outcomes) = one_round(&open) {
        all.push(Judged { name: "one round", trees, outcomes });
    }
    if let Some(withheld) = withheld {
        all.push(of_withheld(&open, &observed(withheld)));
    }
    let about = about(&all, open.len(), &choice);
    Ok(table(&all)
        + "\n"
        + &about
        + &all.iter().filter(|judged| judged.is_listed()).map(misses).collect::<String>())
}

/// What the columns are.
fn about(all: &[Judged], scenes: usize, choice: &Choice) -> String {
    let names: Vec<&str> = choice.facts.iter().map(|fact| fact.name()).collect();
    let facts = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    let mut text = format!(
        "Share of scenes in which the advised tree takes at most 5 % more time in all than the best, and the mean loss. \
         model: fitted to the other {} of {scenes} open scenes (facts: {facts}; ridge {}; both chosen by this loss, so that \
         it flatters a little). same for all: without facts of the scene.",
        scenes - 1,
        choice.ridge
    );
    let has = |name: &str| all.iter().any(|judged| judged.name == name);
    if has("one round") {
        text += " one round: measured once, judged by the later rounds, which shows the noise.";
    }
    if has("withheld") {
        text += " withheld: fitted to all open scenes, among the trees that both runs have.";
    }
    text + "\n"
}

/// Fitted to the open scenes, among the trees in common.
fn of_withheld(open: &[Observed], withheld: &[Observed]) -> Judged {
    let theirs: &[TreeName] = withheld.first().map_or(&[], |scene| &scene.trees);
    let index = |trees: &[TreeName], tree: &TreeName| trees.iter().position(|known| known == tree);
    let common: Vec<TreeName> = open[0].trees.iter().filter(|tree| theirs.contains(tree)).cloned().collect();
    let only = |scenes: &[Observed]| -> Vec<Observed> {
        let keep = |scene: &Observed| -> Vec<usize> {
            common.iter().filter_map(|tree| index(&scene.trees, tree)).collect()
        };
        scenes.iter().map(|scene| scene.only(&keep(scene))).collect()
    };
    let (open, withheld) = (only(open), only(withheld));
    let Choice { facts, ridge } = choose(&open);
    let model = weights(&open.iter().collect::<Vec<_>>(), &facts, ridge);
    let outcomes = withheld.iter().flat_map(|scene| judge(scene, &model.lines(&scene.facts))).collect();
    Judged { name: "withheld", trees: common, outcomes }
}

/// A row for each number of rays: the share of right advice and the mean loss.
pub(super) fn table(all: &[Judged]) -> String {
    let columns = all.iter().flat_map(|judged| [judged.name, "loss"]);
    let mut grid = Grid::new(std::iter::once("rays").chain(columns));
    let cells = |outcomes: &[Outcome]| {
        let share = format!("{:.0} %", 100.0 * share_within(outcomes, RIGHT));
        [share, format!("{:.1} %", 100.0 * (loss(outcomes).exp() - 1.0))]
    };
    for rays in BUDGETS {
        let at = |judged: &Judged| -> Vec<Outcome> {
            judged.outcomes.iter().filter(|outcome| outcome.rays == rays).cloned().collect()
        };
        let of = all.iter().flat_map(|judged| cells(&at(judged)));
        grid.push(std::iter::once(rays_in_words(rays)).chain(of).collect());
    }
    let of = all.iter().flat_map(|judged| cells(&judged.outcomes));
    grid.push(std::iter::once("all".to_owned()).chain(of).collect());
    grid.markdown()
}

impl Judged {
    /// Whether its wrong advice is named.
    fn is_listed(&self) -> bool {
        ["model", "withheld"].contains(&self.name)
    }
}

/// Wrong advice by name, folded away.
pub(super) fn misses(judged: &Judged) -> String {
    let mut grid = Grid::new(["scene", "rays", "advised", "best", "ratio"]);
    let name = |tree: usize| tree_name((&judged.trees[tree].0, judged.trees[tree].1));
    let wrong = judged.outcomes.iter().filter(|outcome| outcome.ratio > RIGHT);
    for Outcome { scene, rays, advised, best, ratio, .. } in wrong {
        grid.push(vec![
            scene.clone(),
            rays_in_words(*rays),
            name(*advised),
            name(*best),
            format!("{ratio:.2}"),
        ]);
    }
    let (wrong, all) = (judged.outcomes.iter().filter(|o| o.ratio > RIGHT).count(), judged.outcomes.len());
    format!(
        "\n<details><summary>{}: {wrong} of {all} pairs of scene and number of rays are not within 5 %</summary>\n\n{}\n</details>\n",
        judged.name,
        grid.markdown()
    )
}
