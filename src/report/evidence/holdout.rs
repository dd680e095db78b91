//! Open scenes beside withheld ones: do builders that were tuned on the first keep their figures on the others?

use crate::bench::row::Row;
use crate::report::figures::interval::of_quotient;
use crate::report::figures::{BASELINE, Figure, Tree, Under, tree_name, trees};
use crate::report::grid::Grid;
use crate::report::means::{Ratios, WORST};
use crate::report::targets::judge::Verdict;
use crate::report::targets::list::{Target, targets};

/// Largest part by which a figure of ours may be worse on withheld scenes.
const WITHIN: f64 = 1.05;

/// Build time, trace time and SAH cost of every tree in both runs, relative to Embree SAH: geometric means, how
/// much the withheld scenes are worse with its interval, whether that is within 5 % for times of ours, and
/// the worst scene of each run. Below, those of our trees with targets that the rows lack.
pub fn holdout(open: &[Row], withheld: &[Row], under: &Under) -> String {
    let mut text = String::new();
    for (title, figure) in
        [("Build time", Figure::Build), ("Trace time", Figure::Trace), ("SAH cost", Figure::Cost)]
    {
        let mut grid = Grid::new([
            "method",
            "open",
            "withheld",
            "ratio",
            "within 5 %",
            "worst open",
            "in",
            "worst withheld",
            "in",
        ]);
        for tree in trees(open) {
            grid.push(line(open, withheld, tree, figure, under).unwrap_or_else(|| vec![tree_name(tree)]));
        }
        text += &format!("### {title}\n\n{}\n", grid.markdown());
    }
    format!(
        "{text}Geometric means relative to Embree SAH, 4-wide, with 95 % intervals over scenes and rounds. ratio: withheld / open, with \
         the interval that those of both runs give, drawn apart. within 5 %: met if all of it is at most {WITHIN}, not met if none \
         is, else undecided; for times of our builders. {WORST} Traces: {}.\n{}",
        under.about(),
        lacking(withheld)
    )
}

/// `None` if one of the runs lacks the figure.
fn line(
    open: &[Row],
    withheld: &[Row],
    tree: Tree<'_>,
    figure: Figure,
    under: &Under,
) -> Option<Vec<String>> {
    let runs = [open, withheld].map(|rows| Ratios::of(rows, tree, figure, under));
    let [open, withheld] = &runs;
    let (a, b) = (open.geometric()?, withheld.geometric()?);
    let is_base = tree == BASELINE;
    let shown = |run: &Ratios| if is_base { Some("1.00".to_owned()) } else { run.shown() };
    let mut cells = vec![tree_name(tree), shown(open)?, shown(withheld)?];
    let interval = of_quotient(&withheld.0, &open.0)?;
    let is_judged = tree.0.starts_with("phr-") || tree.0 == "lbvh";
    let (ratio, verdict) = match is_base {
        true => ("1.00".into(), String::new()),
        false if is_judged && figure != Figure::Cost => {
            (format!("{:.2} {}", b / a, interval.shown(2)), Verdict::at_most(WITHIN, interval).cell())
        }
        false => (format!("{:.2} {}", b / a, interval.shown(2)), "-".into()),
    };
    cells.extend([ratio, verdict]);
    for run in &runs {
        cells.extend(run.worst_shown()?);
    }
    Some(cells)
}

/// Our trees that have targets, but no rows in `withheld`, in a line.
fn lacking(withheld: &[Row]) -> String {
    let known = trees(withheld);
    let mut lacking: Vec<String> = Vec::new();
    for Target { builder, width, .. } in targets() {
        let name = tree_name((builder, width));
        if !builder.starts_with("embree-") && !known.contains(&(builder, width)) && !lacking.contains(&name) {
            lacking.push(name);
        }
    }
    match lacking.is_empty() {
        true => String::new(),
        false => format!("\nNot judged, for the withheld rows lack them: {}.\n", lacking.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figures::GRAFTED;

    fn run(scenes: &[(&str, f64)]) -> Vec<Row> {
        let of_scene = |&(scene, build): &(&str, f64)| {
            let row = |builder, build| Row {
                scene: scene.into(),
                sah: Some(1.0),
                ..Row::by_hand(builder, 4, GRAFTED, build, 1.0)
            };
            [row("embree-sah", 10.0), row("phr-speed", build)]
        };
        scenes.iter().flat_map(of_scene).collect()
    }

    #[test]
    fn withheld_scenes_are_judged_by_the_whole_interval() {
        let open = run(&[("a", 5.0), ("b", 5.05), ("c", 4.95)]);
        let under = Under::One(GRAFTED.into());
        let verdict = |withheld: &[Row]| {
            let text = holdout(&open, withheld, &under);
            let line = text.lines().find(|line| line.starts_with("| phr-speed")).unwrap();
            line.split('|').map(str::trim).nth(5).unwrap().to_owned()
        };
        assert_eq!(verdict(&run(&[("u", 5.0), ("v", 5.02), ("w", 4.98)])), "met");
        assert_eq!(verdict(&run(&[("u", 6.0), ("v", 6.1), ("w", 5.9)])), "not met");
        assert_eq!(verdict(&run(&[("u", 4.0), ("v", 5.2), ("w", 6.6)])), "undecided");
        assert!(
            holdout(&open, &open, &under)
                .contains("lack them: phr-fast, phr-hq, lbvh, phr-draft, phr-turbo, ")
        );
    }
}
