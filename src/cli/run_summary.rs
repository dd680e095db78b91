//! The end of `phr bench`: the best builders, where the results are, and advice on the warnings.

use crate::bench::row::{ROWS, Row};
use crate::bench::samples::SAMPLES;
use crate::bench::warnings::Warning;
use crate::report::figures::{BASELINE, Figure, Tree, Under, scenes, tree_name, trees};
use crate::report::means::Ratios;
use crate::report::plot::pareto::front;
use std::path::{Path, PathBuf};

/// The file of the table in a results folder.
pub const TABLE: &str = "table1.md";
/// Warnings shown; the table has all.
const SHOWN: usize = 3;

/// About ten lines on the run whose `rows` are in `folder`, with the `plots` drawn from them.
pub fn run_summary(rows: &[Row], folder: &Path, plots: &[PathBuf]) -> String {
    let under = Under::best(rows);
    let lines =
        [heading(rows, folder), best_builders(rows, &under), places(rows, folder, plots), advice(rows)];
    lines.concat()
}

fn heading(rows: &[Row], folder: &Path) -> String {
    let counted = |count: usize, noun: &str| format!("{count} {noun}{}", if count == 1 { "" } else { "s" });
    let threads = rows.iter().map(|row| row.threads).max().unwrap_or(0);
    format!(
        "\n## {}: {}, {}, {}\n\n",
        folder.display(),
        counted(scenes(rows).len(), "scene"),
        counted(trees(rows).len(), "tree"),
        counted(threads as usize, "thread"),
    )
}

/// The best tree of each width by each figure, and the trees that no other beats in both build and trace time.
fn best_builders(rows: &[Row], under: &Under) -> String {
    let trees = trees(rows);
    let Some(&base) = trees.iter().find(|&&tree| tree == BASELINE).or(trees.first()) else {
        return String::new();
    };
    let mut widths: Vec<u32> = trees.iter().map(|tree| tree.1).collect();
    widths.sort_unstable();
    widths.dedup();
    let means = |figure| means(rows, &trees, base, figure, under);
    // SAH costs of different widths do not compare.
    let best = |title: &str, means: &[(Tree<'_>, f64)]| {
        let of_width = |&width: &u32| {
            let of = means.iter().filter(|(tree, _)| tree.1 == width);
            let (tree, mean) = of.min_by(|a, b| a.1.total_cmp(&b.1))?;
            Some(format!("{}, {mean:.2}", tree_name(*tree)))
        };
        let of_widths: Vec<String> = widths.iter().filter_map(of_width).collect();
        if of_widths.is_empty() { String::new() } else { format!("{title} {}\n", of_widths.join("; ")) }
    };
    let (builds, traces) = (means(Figure::Build), means(Figure::Trace));
    let names: Vec<String> = widths.iter().map(|width| format!("{width}-wide")).collect();
    let (names, base_name) = (names.join(" and "), format!("{}, {}-wide", base.0, base.1));
    let mut text = format!("{names} trees relative to {base_name}, geometric means over scenes:\n");
    text += &best("fastest build:", &builds);
    text += &best("fastest trace:", &traces);
    text += &best("lowest SAH cost:", &means(Figure::Cost));
    let build_of = |tree| builds.iter().find(|(built, _)| *built == tree).map(|(_, mean)| *mean);
    let points: Vec<(Tree<'_>, (f64, f64))> =
        traces.iter().filter_map(|&(tree, trace)| Some((tree, (build_of(tree)?, trace)))).collect();
    let on_front = front(&points.iter().map(|(_, point)| *point).collect::<Vec<_>>());
    if on_front.len() > 1 {
        let names: Vec<String> = on_front.into_iter().map(|i| tree_name(points[i].0)).collect();
        text += &format!("no other builds and traces as fast: {}\n", names.join(", "));
    }
    if !traces.is_empty() {
        text += &format!("traces: {}\n", under.about());
    }
    text
}

/// The mean of each tree relative to `base`, of trees with a figure in as many scenes as `base`.
fn means<'a>(
    rows: &[Row],
    trees: &[Tree<'a>],
    base: Tree<'_>,
    figure: Figure,
    under: &Under,
) -> Vec<(Tree<'a>, f64)> {
    let ratios = |tree| Ratios::to(base, rows, tree, figure, under);
    let of_base = ratios(base).0.len();
    let whole =
        trees.iter().map(|&tree| (tree, ratios(tree))).filter(|(_, ratios)| ratios.0.len() == of_base);
    whole.filter_map(|(tree, ratios)| Some((tree, ratios.geometric()?))).collect()
}

fn places(rows: &[Row], folder: &Path, plots: &[PathBuf]) -> String {
    let shown = |file: &str| folder.join(file).display().to_string();
    let plots = match plots {
        [] => "none; trees traced beside embree-sah have one, as have builds of two scalable scenes".into(),
        _ => plots.iter().map(|plot| plot.display().to_string()).collect::<Vec<_>>().join(", "),
    };
    let (table, csv) = (shown(TABLE), shown(ROWS));
    format!("\ntable: {table}\nrows: {csv} ({}), every sample in {SAMPLES}\nplot: {plots}\n", rows.len())
}

/// The most frequent warnings, with what to do about each.
fn advice(rows: &[Row]) -> String {
    let totals: Vec<&Row> = rows.iter().filter(|row| row.is_total()).collect();
    let count = |warning: Warning| {
        totals.iter().filter(|row| Warning::parse(&row.warnings).any(|found| found == warning)).count()
    };
    let mut found: Vec<(Warning, usize)> = Warning::ALL.map(|warning| (warning, count(warning))).into();
    found.retain(|(_, count)| *count > 0);
    found.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let shown_warnings = found.iter().take(SHOWN).map(|(warning, count)| {
        format!("{}: {count} of {} rows; {}\n", warning.name(), totals.len(), warning.advice())
    });
    let mut text: String = shown_warnings.collect();
    if found.len() > SHOWN {
        let names: Vec<&str> = found[SHOWN..].iter().map(|(warning, _)| warning.name()).collect();
        text += &format!("also, see {TABLE}: {}\n", names.join(", "));
    }
    text
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
    fn the_best_builders_are_named() {
        let text = run_summary(&rows(), Path::new("out"), &[PathBuf::from("out/figure6.svg")]);
        for line in [
            "## out: 2 scenes, 5 trees, 2 threads",
            "4-wide and 8-wide trees relative to embree-sah, 4-wide, geometric means over scenes:",
            "fastest build: phr-fast, 0.40; embree-sah / 8, 0.30",
            "fastest trace: phr-hq, 0.50; embree-sah / 8, 0.70",
            "lowest SAH cost: embree-sah, 1.00; embree-sah / 8, 0.60",
            "no other builds and traces as fast: embree-sah / 8, phr-hq",
            "table: out/table1.md",
            "rows: out/rows.csv (9), every sample in samples.json",
            "plot: out/figure6.svg",
        ] {
            assert!(text.lines().any(|found| found == line), "no {line:?} in\n{text}");
        }
        // `lbvh` was measured in one scene of two: its mean does not compare.
        assert!(!text.contains("lbvh"), "{text}");
        let lines = text.lines().filter(|line| !line.is_empty()).count();
        assert!((8..=12).contains(&lines), "{lines} lines:\n{text}");
    }

    #[test]
    fn without_embree_the_first_tree_is_the_base() {
        let ours: Vec<Row> = rows().into_iter().filter(|row| row.builder.starts_with("phr-")).collect();
        let text = run_summary(&ours, Path::new("out"), &[]);
        assert!(text.contains("relative to phr-fast") && text.contains("plot: none"), "{text}");
        assert!(run_summary(&[], Path::new("out"), &[]).contains("0 scenes"));
    }

    #[test]
    fn the_most_frequent_warnings_come_with_advice() {
        let mut rows = rows();
        rows[0].warnings = "HighSpread;Outliers;SlowFirst;Contended".into();
        rows[1].warnings = "HighSpread;Outliers;SlowFirst".into();
        rows[2].warnings = "Outliers".into();
        let text = advice(&rows);
        let names: Vec<&str> = text.lines().map(|line| line.split(':').next().unwrap()).collect();
        assert_eq!(names, ["Outliers", "HighSpread", "SlowFirst", "also, see table1.md"], "{text}");
        assert!(text.contains(Warning::HighSpread.advice()) && text.contains("3 of 9 rows"), "{text}");
    }
}
