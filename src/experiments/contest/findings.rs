//! What an experiment found, in words made from its rows.

use super::compared::{Compared, FIGURES, Mean};
use super::experiment::{Comparison, Experiment};
use super::grid;
use crate::bench::row::Row;
use crate::report::ablation::Ablation;
use crate::report::figures::{Figure, Under, scenes, tree_name};
use crate::report::grid::Grid;
use crate::report::readme::findings::EVERY_SCENE;

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
    if !caveat.is_empty() {
        text += &format!(" {caveat}");
    }
    text += &format!(" Traces: {}.\n\n", under.about());
    let compared: Vec<Compared<'_>> =
        comparisons.iter().filter_map(|comparison| Compared::of(comparison, rows, width, &under)).collect();
    text += &(means(&compared) + "\n" + &claims(&compared));
    if name == &"grid" {
        text += &format!("{}\n", grid::findings(rows, width, &under));
    }
    text + &failures(rows) + &format!("{EVERY_SCENE}\n\n") + &tables(&comparisons, rows, width)
}

/// The means of every comparison, and in how many scenes traces are slower.
fn means(compared: &[Compared<'_>]) -> String {
    let names = FIGURES.iter().map(|(name, _)| *name);
    let mut grid =
        Grid::new(["builder", "relative to"].into_iter().chain(names).chain(["trace, by scene", "slower"]));
    for one in compared {
        let Comparison { changed, base, .. } = one.comparison;
        let figures =
            one.ratios.iter().map(|ratios| Mean::of(ratios).map_or_else(String::new, |m| m.shown()));
        let traces = one.of_figure(Figure::Trace);
        let range = traces.least().zip(traces.worst()).map_or_else(String::new, |(least, most)| {
            format!("{:.2} {} to {:.2} {}", least.value, least.scene, most.value, most.scene)
        });
        let slower = traces.0.iter().filter(|ratio| ratio.value > 1.0).count();
        let last = [range, format!("{slower} of {}", traces.0.len())];
        grid.push([changed.clone(), base.clone()].into_iter().chain(figures).chain(last).collect());
    }
    grid.markdown()
}

/// What the paper leads to expect, and what becomes of it; nothing where it does not say.
fn claims(compared: &[Compared<'_>]) -> String {
    let mut grid = Grid::new(["that", "builder", "relative to", "ours", ""]);
    for one in compared {
        let Comparison { changed, base, expected } = one.comparison;
        for expectation in expected {
            let ratios = one.of_figure(expectation.figure);
            let mean = match expectation.scenes {
                [] => Mean::of(ratios),
                scenes => Mean::in_scenes(ratios, scenes),
            };
            let verdict = mean.map_or("was not measured", |mean| mean.verdict(expectation.range));
            let shown = mean.map_or_else(String::new, |mean| mean.shown());
            grid.push(vec![expectation.says.into(), changed.clone(), base.clone(), shown, verdict.into()]);
        }
    }
    if grid.is_empty() { String::new() } else { grid.markdown() + "\n" }
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
