//! The end of `phr bench`: the verdict, where the results are, and advice on the warnings.

use crate::bench::results_dir::{PAGE, TABLE};
use crate::bench::row::{ROWS, Row};
use crate::bench::samples::SAMPLES;
use crate::bench::warnings::Warning;
use crate::report::figures::{Figure, Tree, Under, scenes, tree_name, trees};
use crate::report::plot::pareto::front;
use crate::report::table::brief::filled;
use crate::report::table::warned;
use crate::report::verdict::field::Field;
use crate::report::verdict::{Sentence, verdict};
use std::path::{Path, PathBuf};

/// Warnings shown, so that the end stays short; the table has all.
const SHOWN: usize = 1;

/// About ten lines on the run whose `rows` are in `folder`, with the `plots` drawn from them; none but a path is longer
/// than a terminal.
pub fn run_summary(rows: &[Row], folder: &Path, plots: &[PathBuf]) -> String {
    [heading(rows, folder), answer(rows), advice(rows), places(rows, folder, plots)].concat()
}

fn heading(rows: &[Row], folder: &Path) -> String {
    let counted = |count: usize, noun: &str| format!("{count} {noun}{}", if count == 1 { "" } else { "s" });
    let threads = rows.iter().map(|row| row.threads).max().unwrap_or(0);
    let heading = filled(&format!(
        "## {}: {}, {}, {}",
        folder.display(),
        counted(scenes(rows).len(), "scene"),
        counted(trees(rows).len(), "tree"),
        counted(threads as usize, "thread"),
    ));
    format!("\n{heading}\n")
}

/// The verdict, and the builders that no other beats in both build and trace time.
fn answer(rows: &[Row]) -> String {
    let Some(field) = Field::of(rows) else { return String::new() };
    let under = Under::best(rows);
    let mut text: String =
        verdict(&field, &under).iter().map(Sentence::text).map(|sentence| filled(&sentence)).collect();
    let mean = |tree: Tree<'_>, figure| field.whole_ratios(tree, figure, &under)?.geometric();
    let point =
        |tree: Tree<'_>| Some((tree_name(tree), (mean(tree, Figure::Build)?, mean(tree, Figure::Trace)?)));
    let (names, points): (Vec<String>, Vec<(f64, f64)>) = field.built().filter_map(point).unzip();
    let on_front: Vec<&str> =
        front(&points).into_iter().filter_map(|i| names.get(i)).map(String::as_str).collect();
    if on_front.len() > 1 {
        text += &filled(&format!("No other builds and traces as fast: {}.", on_front.join(", ")));
    }
    if points.is_empty() { text } else { text + &filled(&format!("Traces: {}.", under.about())) }
}

fn places(rows: &[Row], folder: &Path, plots: &[PathBuf]) -> String {
    let shown = |file: &str| folder.join(file).display().to_string();
    let plots: Vec<String> = plots
        .iter()
        .filter(|plot| plot.extension().is_some_and(|ending| ending == "png"))
        .map(|plot| plot.display().to_string())
        .collect();
    let plots = match plots.as_slice() {
        [] => "none; trees traced beside embree-sah have one, as have builds of two scalable scenes".into(),
        [plot] => plot.clone(),
        [first, others @ ..] => format!("{first} and {} more beside it", others.len()),
    };
    let (table, csv, page) = (shown(TABLE), shown(ROWS), shown(PAGE));
    format!(
        "\ntable: {table}\nrows:  {csv} ({}), every sample in {SAMPLES}\nplots: {plots}\npage:  {page}\n",
        rows.len()
    )
}

/// The most frequent warning, with what to do about it, and the names of others.
fn advice(rows: &[Row]) -> String {
    let mut found = warned(rows);
    found.sort_by_key(|(_, count, _)| std::cmp::Reverse(*count));
    let shown = found.iter().take(SHOWN).map(|(warning, count, of)| {
        filled(&format!("{}: {count} of {of} rows; {}", warning.name(), warning.advice()))
    });
    let mut text: String = shown.collect();
    let names: Vec<&str> = found.iter().skip(SHOWN).map(|(warning, ..)| Warning::name(*warning)).collect();
    if !names.is_empty() {
        text += &filled(&format!("also, see {TABLE}: {}", names.join(", ")));
    }
    if text.is_empty() { text } else { format!("\n{text}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(scene: &str, builder: &str, build: f64, trace: f64) -> Row {
        let kernel = if builder.starts_with("embree-") { "embree-native" } else { "phr" };
        Row { scene: scene.into(), sah: Some(10.0), ..Row::by_hand(builder, 4, kernel, build, trace) }
    }

    fn rows() -> Vec<Row> {
        vec![
            row("a", "embree-sah", 10.0, 10.0),
            row("a", "phr-fast", 2.0, 11.0),
            row("a", "phr-hq", 8.0, 5.0),
            row("a", "lbvh", 3.0, 20.0),
            row("b", "embree-sah", 10.0, 10.0),
            row("b", "phr-fast", 8.0, 11.0),
            row("b", "phr-hq", 8.0, 5.0),
            Row { width: 8, sah: Some(6.0), ..row("a", "embree-sah", 3.0, 7.0) },
            Row { width: 8, sah: Some(6.0), ..row("b", "embree-sah", 3.0, 7.0) },
        ]
    }

    #[test]
    fn the_verdict_and_the_places_are_told() {
        let plots = ["out/figure6.svg", "out/figure6.png", "out/phases.png"].map(PathBuf::from);
        let text = run_summary(&rows(), Path::new("out"), &plots);
        for line in [
            "## out: 2 scenes, 5 trees, 2 threads",
            "embree-sah / 8 builds fastest: in 0.30 [0.30, 0.30] of its build time, and traces in 0.70 [0.70, 0.70] of its time; not",
            "told apart from it is phr-fast.",
            "No other builds and traces as fast: embree-sah / 8, phr-hq.",
            "table: out/table1.md",
            "rows:  out/rows.csv (9), every sample in samples.json",
            "plots: out/figure6.png and 1 more beside it",
            "page:  out/report.html",
        ] {
            assert!(text.lines().any(|found| found == line), "no {line:?} in\n{text}");
        }
        assert!(text.contains("Over 2 scenes on 2 threads, phr-hq traces fastest: in 0.50 "), "{text}");
        // `lbvh` was measured in one scene of two: its mean does not compare.
        assert!(!text.contains("lbvh"), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= 120), "{text}");
    }

    #[test]
    fn without_embree_the_first_tree_is_the_base() {
        let ours: Vec<Row> = rows().into_iter().filter(|row| row.builder.starts_with("phr-")).collect();
        let text = run_summary(&ours, Path::new("out"), &[]);
        assert!(text.contains("of the time of phr-fast, 4-wide") && text.contains("plots: none"), "{text}");
        assert!(run_summary(&[], Path::new("out"), &[]).contains("0 scenes"));
    }

    #[test]
    fn a_saved_tree_is_told_of_and_not_praised() {
        let rows = [rows(), vec![row("a", "saved:x", 0.1, 1.0), row("b", "saved:x", 0.1, 1.0)]].concat();
        let text = run_summary(&rows, Path::new("out"), &[]);
        let told: Vec<&str> = text.lines().filter(|line| line.contains("saved:")).collect();
        assert_eq!(told, ["saved:x loads in 0.100 ms for a.", "saved:x loads in 0.100 ms for b."], "{text}");
        let alone = run_summary(&rows[rows.len() - 2..], Path::new("out"), &[]);
        assert!(
            alone.contains("loads in") && !alone.contains("fastest") && !alone.contains("Traces"),
            "{alone}"
        );
    }

    #[test]
    fn the_most_frequent_warning_comes_with_advice() {
        let mut rows = rows();
        rows[0].warnings = "HighSpread;Outliers;SlowFirst;Contended".into();
        rows[1].warnings = "HighSpread;Outliers;SlowFirst".into();
        rows[2].warnings = "Outliers".into();
        let text = advice(&rows);
        let lines = text.lines().filter(|line| !line.is_empty());
        let names: Vec<&str> = lines.map(|line| line.split(':').next().unwrap()).collect();
        assert_eq!(names, ["Outliers", "also, see table1.md"], "{text}");
        assert!(text.contains(Warning::Outliers.advice()) && text.contains("3 of 9 rows"), "{text}");
        assert!(text.contains("HighSpread, SlowFirst, Contended"), "{text}");
    }
}
