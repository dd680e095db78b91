//! What matters of a run, for a terminal: build, cost and trace of every tree, each relative to Embree SAH with its
//! interval. No line is longer than [`COLUMNS`].

use super::details::{grouped, interval};
use crate::bench::row::Row;
use crate::report::figures::{
    BASELINE, Figure, SceneFigures, Tree, Under, WIDTH, has_baseline, scenes, tree_name, trees,
};
use crate::report::grid::{Grid, short};
use crate::report::means::Ratios;
use crate::report::verdict::field::Field;

/// Columns of a terminal that every line fits.
pub const COLUMNS: usize = 120;

/// One scene's table, under a heading, traces compared under the fairest kernel of `rows`.
pub fn scene(rows: &[Row], scene: &str) -> String {
    let of_scene = SceneFigures::of(rows, scene);
    let under = Under::best(rows);
    let mut grid = Grid::new(
        ["tree", "build ms", "/SAH", "SAH cost", "/SAH", "trace ms", "Mrays/s", "/SAH"]
            .map(Into::<String>::into),
    );
    for tree in trees(of_scene.totals().iter().copied()) {
        grid.push(line(&of_scene, tree, &under));
    }
    let triangles = grouped(of_scene.triangles());
    filled(&format!("## {scene}: {triangles} triangles")) + "\n" + &grid.within(COLUMNS)
}

fn line(of_scene: &SceneFigures<'_>, tree: Tree<'_>, under: &Under) -> Vec<String> {
    let figure = |figure| of_scene.figure(tree, figure, under).cell(|value| short(value.median));
    let ratio = |figure| match of_scene.ratio(tree, figure, under) {
        Some(_) if tree == BASELINE => "1".into(),
        Some(ratio) if figure == Figure::Cost => format!("{:.2}", ratio.value),
        Some(ratio) => interval(&ratio),
        None => String::new(),
    };
    let speed = of_scene.trace(tree, under.kernel_of(tree.0)).and_then(|row| row.mrays_s);
    vec![
        tree_name(tree),
        figure(Figure::Build),
        ratio(Figure::Build),
        figure(Figure::Cost),
        ratio(Figure::Cost),
        figure(Figure::Trace),
        speed.cell(short),
        ratio(Figure::Trace),
    ]
}

/// The means over scenes; nothing for one scene, and nothing without Embree SAH.
pub fn means(rows: &[Row]) -> String {
    let under = Under::best(rows);
    let Some(field) = Field::of(rows).filter(|field| field.scenes.len() > 1 && field.base == BASELINE) else {
        return String::new();
    };
    let mut grid = Grid::new(["tree", "build", "SAH cost", "trace", "worst", "in"].map(Into::<String>::into));
    let mut are_whole = true;
    for &tree in &field.trees {
        let of = |figure| field.ratios(tree, figure, &under);
        let (build, cost, traces) = (of(Figure::Build), of(Figure::Cost), of(Figure::Trace));
        let shown = |ratios: &Ratios| match ratios.0.is_empty() {
            true => String::new(),
            false if tree == BASELINE => "1".into(),
            false => ratios.shown().unwrap_or_default(),
        };
        let [worst, worst_in] = traces.worst_shown().filter(|_| tree != BASELINE).unwrap_or_default();
        let is_whole =
            [&build, &cost, &traces].iter().all(|it| it.0.is_empty() || it.0.len() == field.scenes.len());
        are_whole &= is_whole;
        grid.push(vec![
            tree_name(tree) + if is_whole { "" } else { "*" },
            shown(&build),
            cost.geometric().map_or_else(String::new, |cost| format!("{cost:.2}")),
            shown(&traces),
            worst,
            worst_in,
        ]);
    }
    let fewer = if are_whole { "" } else { "* mean over fewer scenes\n" };
    let (count, base) = (field.scenes.len(), BASELINE.0);
    format!("## Means over {count} scenes, relative to {base}\n\n{}{fewer}\n", grid.within(COLUMNS))
}

/// What the columns mean, in lines that fit.
pub fn legend(rows: &[Row]) -> String {
    let Some(row) = rows.first() else { return String::new() };
    let rounds = super::rounds(rows.iter().filter(|row| row.error.is_empty()));
    let rounds = super::counted_rounds(&rounds);
    let means = if scenes(rows).len() > 1 {
        "; [ ] around means is the 95 % interval over scenes and rounds, behind the worst scene's ratio its own over rounds; not told \
         apart: from the mean, which that holds"
    } else {
        ""
    };
    // Without it there is no such column, nor a mean.
    let relative = if has_baseline(rows) {
        let base = BASELINE.0;
        format!(
            " /SAH: relative to {base}, {WIDTH}-wide; ± half the 95 % interval over rounds (±?: too few, or too far apart){means}."
        )
    } else {
        String::new()
    };
    filled(&format!(
        "Trees are {WIDTH}-wide, or 8-wide (/ 8). Medians of {rounds}, {} threads on each side, builds on warm threads \
         in new memory.{relative} Traces: all recorded rays of all views, {}. --all-columns shows first and repeated \
         builds and every kernel.",
        row.threads,
        Under::best(rows).about()
    ))
}

/// A text in lines that fit a terminal.
pub fn filled(text: &str) -> String {
    // Names of options stay whole.
    let whole = textwrap::Options::new(COLUMNS).word_splitter(textwrap::WordSplitter::NoHyphenation);
    textwrap::fill(text, whole) + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figures::{NATIVE, PHR};

    fn row(scene: &str, builder: &str, width: u32, kernel: &str, build: f64, trace: f64) -> Row {
        Row {
            scene: scene.into(),
            triangles: 12_345_678,
            sah: Some(1234.5),
            rays: Some(1_000_000),
            mrays_s: Some(1000.0 / trace),
            ..Row::by_hand(builder, width, kernel, build, trace)
        }
    }

    fn rows() -> Vec<Row> {
        ["a", "a scene with a name that goes on and on and on"]
            .into_iter()
            .flat_map(|scene| {
                [
                    row(scene, "embree-sah", 4, NATIVE, 123_456.0, 98_765.0),
                    row(scene, "embree-fast-spatial", 8, NATIVE, 1_234_567.0, 8765.0),
                    row(scene, "phr-quality[auxiliary_leaf=off]", 8, PHR, 61_728.0, 1_197_530.0),
                ]
            })
            .collect()
    }

    #[test]
    fn no_line_is_too_long() {
        let names = ["tuned-".repeat(10), format!("phr-hq[{}max_cut=4096]", "alpha=0.5+".repeat(20))];
        let long_scene = "a scene with a name that goes on ".repeat(5);
        let with = |name: &str| {
            let mut rows = rows();
            for row in &mut rows {
                if row.builder.starts_with("phr") {
                    row.builder = name.into();
                }
                if row.scene != "a" {
                    row.scene.clone_from(&long_scene);
                }
            }
            rows
        };
        for rows in [rows(), with(&names[0]), with(&names[1])] {
            for text in [scene(&rows, "a") + &scene(&rows, &rows[3].scene), means(&rows) + &legend(&rows)] {
                let longest = text.lines().map(|line| line.chars().count()).max().unwrap();
                assert!((80..=COLUMNS).contains(&longest), "{longest} columns\n{text}");
                assert!(text.replace('\n', "").contains(&rows[2].builder), "{text}");
            }
        }
    }

    #[test]
    fn each_figure_is_relative_to_embree_sah() {
        let text = scene(&rows(), "a");
        let cells: Vec<&str> = text
            .lines()
            .find(|line| line.contains("phr-quality"))
            .unwrap()
            .split('|')
            .map(str::trim)
            .collect();
        assert_eq!(cells[1..4], ["phr-quality[auxiliary_leaf=off] / 8", "61728", "0.50 ±0.00"], "{text}");
        assert_eq!(cells[4..9], ["1234", "1.00", "1197530", "0.001", "12.13 ±0.00"], "{text}");
        assert!(means(&rows()).contains(" 0.50 [0.50, 0.50] |"), "{}", means(&rows()));
    }

    #[test]
    fn a_mean_over_fewer_scenes_is_marked() {
        assert!(!means(&rows()).contains('*'));
        let mut rows = rows();
        // Its traces in the second scene are wrong.
        let wrong = rows.iter_mut().rfind(|row| row.builder.starts_with("phr")).unwrap();
        wrong.trace_ms_median = None;
        let text = means(&rows);
        assert!(text.contains("/ 8*") && text.contains("* mean over fewer scenes"), "{text}");
    }

    #[test]
    fn without_embree_there_are_figures_but_no_means() {
        let ours: Vec<Row> = rows().into_iter().filter(|row| row.builder.starts_with("phr")).collect();
        assert!(scene(&ours, "a").contains("61728") && !scene(&ours, "a").contains('±'));
        assert_eq!(means(&ours), "");
        assert!(!legend(&ours).contains("/SAH") && !legend(&ours).contains("[ ]"), "{}", legend(&ours));
        assert!(legend(&rows()).contains("/SAH: "), "{}", legend(&rows()));
    }
}
