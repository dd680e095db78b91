//! What an experiment found, in words made from its rows.

use super::compared::{Compared, Mean, OF_ROUNDS, name};
use super::experiment::{Comparison, Experiment};
use crate::bench::row::Row;
use crate::report::ablation::Ablation;
use crate::report::figures::{Figure, SceneFigures, Under, only, tree_name};
use crate::report::grid::Grid;
use crate::report::means::Ratios;
use crate::report::readme::findings::EVERY_SCENE;
use crate::report::table::{counted_rounds, rounds, warned};

/// The paragraph of an experiment over trees of `width`, what the paper leads to expect, and a table of every scene.
pub fn findings(experiment: &Experiment, rows: &[Row], width: u32) -> String {
    let under = Under::best(rows);
    let entrants = (experiment.entrants)();
    let own = only(rows, |row| row.width == width && entrants.contains(&row.builder));
    let comparisons = (experiment.comparisons)();
    let scenes = SceneFigures::all(rows);
    let compared: Vec<Compared<'_>> = comparisons
        .iter()
        .filter_map(|comparison| Compared::of(comparison, experiment.figures, &scenes, width, &under))
        .collect();
    let mut text = heading(experiment, &own, width, &under) + &in_short(&compared, rows);
    let told = means(&compared) + "\n" + &claims(&compared, rows);
    text += &told;
    text += remark(&told);
    if let Some(more) = experiment.more {
        text += &format!("{}\n", more(rows, width, &under));
    }
    text += &(failures(rows) + &warnings(&own));
    text + &format!("{EVERY_SCENE}\n\n") + &tables(&comparisons, rows, width)
}

/// What was asked, of what it is told, and how it was measured.
fn heading(experiment: &Experiment, rows: &[Row], width: u32, under: &Under) -> String {
    let Experiment { name, section, about, paper, caveat, .. } = experiment;
    let count = SceneFigures::all(rows).len();
    let noun = if count == 1 { "scene" } else { "scenes" };
    let threads = rows.first().map_or(0, |row| row.threads);
    let frames = SceneFigures::traced_by(&SceneFigures::all(rows), under) == Figure::Frame;
    let frames = if frames { "whole frames, " } else { "" };
    // Rows of another kernel tell steps; those of builds alone have none.
    let traced = only(rows, |row| under.compares(row));
    let compared = if traced.is_empty() { rows.to_vec() } else { traced };
    let caveat = if caveat.is_empty() { String::new() } else { format!(" {caveat}") };
    format!(
        "# {name}\n\n{about}. Means over {count} {noun}, {width}-wide trees, {threads} threads, in brackets 95 % intervals. The \
         paper ({section}): {paper}.{caveat} Traces: {frames}{}{}, {}. Steps: inner nodes visited and leaf blocks \
         tested per ray under our kernel; they have no noise.\n\n",
        rays(&compared),
        counted_rounds(&rounds(compared.iter().filter(|row| row.is_good()))),
        under.about()
    )
}

/// What was found, in a paragraph: which of the paper's statements hold, each once with its figures, and what was
/// found where it makes none.
fn in_short(compared: &[Compared<'_>], rows: &[Row]) -> String {
    let mut told = Vec::new();
    let judged = judged(compared, rows);
    for verdict in ["holds", "does not hold", "is undecided"] {
        let those = judged.iter().filter(|(_, judged)| *judged == verdict);
        let those: Vec<&str> = those.map(|(statement, _)| statement.as_str()).collect();
        if !those.is_empty() {
            told.push(format!("{} {}", heading_of(verdict), those.join("; ")));
        }
    }
    let silent: Vec<String> =
        compared.iter().filter(|one| one.comparison.expected.is_empty()).map(differences).collect();
    if !silent.is_empty() {
        told.push(format!("Without a statement of the paper: {}", silent.join("; ")));
    }
    if told.is_empty() { String::new() } else { format!("{}.\n\n", told.join(". ")) }
}

fn heading_of(verdict: &str) -> &'static str {
    match verdict {
        "holds" => "What holds:",
        "does not hold" => "What does not hold:",
        _ => "Undecided:",
    }
}

/// The paper's statements that were measured, in words and by their own figure, each with its verdict.
fn judged(compared: &[Compared<'_>], rows: &[Row]) -> Vec<(String, &'static str)> {
    let mut all = Vec::new();
    for one in compared {
        let Comparison { changed, base, expected } = one.comparison;
        for expectation in expected {
            let ratios = one.of_figure(expectation.figure);
            let Some(mean) = ratios.and_then(|ratios| Mean::among(ratios, expectation.among, rows)) else {
                continue;
            };
            let statement =
                format!("`{changed}` relative to `{base}`: {} ({})", expectation.says, mean.cell());
            all.push((statement, mean.verdict(expectation.range)));
        }
    }
    all
}

/// The means of a comparison that are not 1, or that none is told from it.
fn differences(one: &Compared<'_>) -> String {
    let Comparison { changed, base, .. } = one.comparison;
    let differs = |(figure, ratios): &(Figure, Ratios)| {
        let mean = Mean::of(ratios)?;
        let interval = mean.interval?;
        (interval.low > 1.0 || interval.high < 1.0).then(|| format!("{} {}", name(*figure), mean.cell()))
    };
    let told: Vec<String> = one.ratios.iter().filter_map(differs).collect();
    let told = if told.is_empty() { "nothing is told from 1".to_owned() } else { told.join(", ") };
    format!("`{changed}` relative to `{base}`: {told}")
}

/// The least and the greatest number of rays of a scene.
fn rays(rows: &[Row]) -> String {
    let thousands =
        || rows.iter().filter(|row| row.is_total()).filter_map(|row| Some((row.rays? + 500) / 1000));
    match (thousands().min(), thousands().max()) {
        (Some(least), Some(most)) if least < most => format!("{least} to {most} thousand rays of a scene, "),
        (Some(all), _) => format!("{all} thousand rays of a scene, "),
        _ => String::new(),
    }
}

/// The means of every comparison, the scenes with fewest and most steps, and in how many scenes the trees are worse.
fn means(compared: &[Compared<'_>]) -> String {
    let Some(first) = compared.first() else { return String::new() };
    let figures: Vec<&str> = first.ratios.iter().map(|(figure, _)| name(*figure)).collect();
    let of_trees =
        |figure: Figure| figure != Figure::Build && compared.iter().any(|one| one.is_measured(figure));
    let worse: Vec<&str> = first
        .ratios
        .iter()
        .filter(|(figure, _)| of_trees(*figure))
        .map(|(figure, _)| name(*figure))
        .collect();
    let header = ["builder".to_owned(), "relative to".into()].into_iter();
    let header = header.chain(figures.into_iter().map(String::from));
    let mut grid =
        Grid::new(header.chain(["steps, by scene".into(), format!("more {} in", worse.join(", "))]));
    for one in compared {
        let Comparison { changed, base, .. } = one.comparison;
        let means =
            one.ratios.iter().map(|(_, ratios)| Mean::of(ratios).map_or_else(String::new, |m| m.cell()));
        let ends = one.of_figure(Figure::Steps).and_then(|steps| steps.least().zip(steps.worst()));
        let range = ends.map_or_else(String::new, |(least, most)| {
            format!("{:.2} {} to {:.2} {}", least.value, least.scene, most.value, most.scene)
        });
        let trees = || one.ratios.iter().filter(|(figure, _)| of_trees(*figure)).map(|(_, ratios)| &ratios.0);
        let more = trees().map(|ratios| ratios.iter().filter(|ratio| ratio.value > 1.0).count().to_string());
        let of = trees().map(Vec::len).max().unwrap_or(0);
        let more = format!("{} of {of}", more.collect::<Vec<_>>().join(", "));
        grid.push([changed.clone(), base.clone()].into_iter().chain(means).chain([range, more]).collect());
    }
    grid.markdown()
}

/// What the paper leads to expect, and what becomes of it, beside its own figure where its Table 1 has one; nothing
/// where it does not say. What it says of traces is judged by their steps too.
fn claims(compared: &[Compared<'_>], rows: &[Row]) -> String {
    let mut grid = Grid::new(["that", "by", "builder", "relative to", "paper", "ours", ""]);
    for one in compared {
        let Comparison { changed, base, expected } = one.comparison;
        for expectation in expected {
            let figures = match expectation.figure {
                Figure::Trace => vec![Figure::Trace, Figure::Steps],
                figure => vec![figure],
            };
            for figure in figures {
                let ratios = one.of_figure(figure);
                let mean = ratios.and_then(|ratios| Mean::among(ratios, expectation.among, rows));
                let verdict = mean.map_or("was not measured", |mean| mean.verdict(expectation.range));
                let shown = mean.map_or_else(String::new, |mean| mean.cell());
                let paper = expectation.among.of_paper(one.comparison, figure);
                let paper = paper.map_or_else(String::new, |ratio| format!("{ratio:.2}"));
                let says = [expectation.says, name(figure), changed, base].map(String::from);
                grid.push(says.into_iter().chain([paper, shown, verdict.into()]).collect());
            }
        }
    }
    if grid.is_empty() { String::new() } else { grid.markdown() + "\n" }
}

/// What intervals over rounds mean, below tables that have some.
fn remark(tables: &str) -> &'static str {
    if !tables.contains(OF_ROUNDS) {
        return "";
    }
    "rounds: an interval over the rounds of these very scenes alone, as another measurement of them would give; it says \
     nothing of other scenes.\n\n"
}

/// Rows without figures, so that none is missed.
fn failures(rows: &[Row]) -> String {
    let failed = rows.iter().filter(|row| row.is_total() && !row.is_good());
    let told = failed.map(|row| format!("No figures: {} {}: {}\n\n", row.scene, row.builder, row.error));
    told.collect()
}

/// The defects of the rows, each with how many have it.
fn warnings(rows: &[Row]) -> String {
    let told =
        warned(rows).into_iter().map(|(warning, count, of)| format!("{} {count} of {of}", warning.name()));
    let told: Vec<String> = told.collect();
    if told.is_empty() { String::new() } else { format!("Warnings, by rows: {}.\n\n", told.join(", ")) }
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

#[cfg(test)]
mod tests {
    use super::super::compared::FIGURES;
    use super::super::list::by_name;
    use super::*;
    use crate::report::figures::{GRAFTED, PHR};

    fn rows(builder: &str, scene: &str, build: f64) -> [Row; 2] {
        [GRAFTED, PHR]
            .map(|kernel| Row { scene: scene.into(), ..Row::by_hand(builder, 4, kernel, build, 10.0) })
    }

    #[test]
    fn intervals_over_rounds_alone_are_told() {
        let comparisons = (by_name("grid").unwrap().comparisons)();
        let comparison = &comparisons[0];
        let of = |scene: &str| {
            [rows(&comparison.changed, scene, 6.0), rows(&comparison.base, scene, 10.0)].concat()
        };
        let told = |rows: &[Row]| {
            let under = Under::best(rows);
            let compared = [Compared::of(comparison, FIGURES, &SceneFigures::all(rows), 4, &under).unwrap()];
            [means(&compared), claims(&compared, rows)]
        };
        // The claims are about scenes of the paper.
        let [of_all, of_paper] = told(&[of("sanmiguel-like"), of("rooms")].concat());
        assert!(of_all.contains(" 0.60 [0.60, 0.60] |") && remark(&of_all).is_empty(), "{of_all}");
        assert!(of_paper.contains(" 0.60 [0.60, 0.60], rounds |"), "{of_paper}");
        assert!(remark(&of_paper).starts_with("rounds: "));
        let in_short = |rows: &[Row]| {
            let under = Under::best(rows);
            in_short(&[Compared::of(comparison, FIGURES, &SceneFigures::all(rows), 4, &under).unwrap()], rows)
        };
        let short = in_short(&[of("sanmiguel-like"), of("rooms")].concat());
        assert!(
            short.starts_with(
                "What holds: `phr-hq[alpha=0.5+delta=7]` relative to `phr-hq[alpha=0.55+delta=9]`: "
            ),
            "{short}"
        );
        assert!(short.contains("it builds about 35 % faster there (0.60 [0.60, 0.60], rounds)"), "{short}");
        let [of_one, _] = told(&of("rooms"));
        assert!(of_one.contains(" 0.60 [0.60, 0.60], rounds |"), "{of_one}");
    }
}
