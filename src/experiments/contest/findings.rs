//! What an experiment found, in words made from its rows.

use super::compared::{Compared, FIGURES, Mean};
use super::experiment::{Comparison, Experiment};
use super::grid;
use crate::bench::row::Row;
use crate::report::ablation::Ablation;
use crate::report::figures::{Figure, Under, scenes, tree_name};

/// The paragraph of an experiment over trees of `width`, and a table of every scene.
pub fn findings(experiment: &Experiment, rows: &[Row], width: u32) -> String {
    let under = Under::best(rows);
    let comparisons = (experiment.comparisons)();
    let Experiment { name, section, paper, caveat, .. } = experiment;
    let count = scenes(rows).len();
    let threads = rows.first().map_or(0, |row| row.threads);
    let mut text = format!(
        "# {name}\n\n{}. Means over {count} {}, {width}-wide trees, {threads} threads, in brackets 95 % intervals. The paper \
         ({section}): {paper}.",
        experiment.about,
        if count == 1 { "scene" } else { "scenes" },
    );
    for comparison in &comparisons {
        if let Some(compared) = Compared::of(comparison, rows, width, &under) {
            text += &sentence(&compared);
        }
    }
    if !caveat.is_empty() {
        text += &format!(" {caveat}");
    }
    text += &format!(" Traces: {}.\n\n", under.about());
    if name == &"grid" {
        text += &format!("{}\n", grid::findings(rows, width, &under));
    }
    text + &failures(rows) + &tables(&comparisons, rows, width)
}

/// The means of a comparison, its worst and best scene, and what becomes of the expectations.
fn sentence(compared: &Compared<'_>) -> String {
    let Comparison { changed, base, expected } = compared.comparison;
    let means = FIGURES
        .iter()
        .zip(&compared.ratios)
        .filter_map(|((name, _), ratios)| Some(format!("{name} {}", Mean::of(ratios)?.shown())));
    let mut text = format!(" {changed} relative to {base}: {}", means.collect::<Vec<_>>().join(", "));
    let traces = compared.of_figure(Figure::Trace);
    if let (Some(least), Some(most), true) = (traces.least(), traces.worst(), traces.0.len() > 1) {
        let slower = traces.0.iter().filter(|ratio| ratio.value > 1.0).count();
        text += &format!(
            " (from {:.2} in {} to {:.2} in {}; slower in {slower} of {})",
            least.value,
            least.scene,
            most.value,
            most.scene,
            traces.0.len()
        );
    }
    for expectation in expected {
        let ratios = compared.of_figure(expectation.figure);
        let (told, mean) = match expectation.scenes {
            [] => (String::new(), Mean::of(ratios)),
            scenes => {
                let mean = Mean::in_scenes(ratios, scenes);
                (mean.map_or_else(String::new, |mean| format!(" ({})", mean.shown())), mean)
            }
        };
        let verdict = mean.map_or("was not measured", |mean| mean.verdict(expectation.range));
        text += &format!("; that {} {verdict}{told}", expectation.says);
    }
    text + "."
}

/// Rows without figures, so that none is missed.
fn failures(rows: &[Row]) -> String {
    let failed = rows.iter().filter(|row| row.is_total() && !row.is_good());
    let told = failed.map(|row| format!("No figures: {} {}: {}\n\n", row.scene, row.builder, row.error));
    told.collect()
}

/// Every scene, a table for each builder that others are compared with.
fn tables(comparisons: &[Comparison], rows: &[Row], width: u32) -> String {
    let mut bases: Vec<&str> = comparisons.iter().map(|comparison| comparison.base.as_str()).collect();
    bases.dedup();
    let name = |builder: &str| tree_name((builder, width)).replace(" / ", "/");
    let table = |base: &&str| {
        let changed = comparisons.iter().filter(|comparison| comparison.base == **base);
        let names: Vec<String> = changed.map(|comparison| name(&comparison.changed)).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        Ablation::of(rows, &name(base), &names).ok().map(|table| table.text())
    };
    bases.iter().filter_map(table).collect::<Vec<_>>().join("\n")
}
