//! Open scenes beside withheld ones: do builders that were tuned on the first keep their figures on the others?

use crate::bench::row::Row;
use crate::report::figures::{BASELINE, Figure, Tree, Under, tree_name, trees};
use crate::report::grid::Grid;
use crate::report::means::Ratios;

/// Build time, trace time and SAH cost of every tree in both runs, relative to Embree SAH: geometric means, how much the
/// withheld scenes are worse, and the worst scene of each run.
pub fn holdout(open: &[Row], withheld: &[Row], under: &Under) -> String {
    let mut text = String::new();
    for (title, figure) in
        [("Build time", Figure::Build), ("Trace time", Figure::Trace), ("SAH cost", Figure::Cost)]
    {
        let mut grid =
            Grid::new(["method", "open", "withheld", "ratio", "worst open", "in", "worst withheld", "in"]);
        for tree in trees(open) {
            grid.push(line(open, withheld, tree, figure, under).unwrap_or_else(|| vec![tree_name(tree)]));
        }
        text += &format!("### {title}\n\n{}\n", grid.markdown());
    }
    text + "Geometric means relative to Embree SAH, 4-wide, with 95 % intervals over scenes and rounds, and the scene with \
            the largest ratio. ratio: withheld / open. \
            Traces: "
        + &under.about()
        + ".\n"
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
    let shown = |run: &Ratios| if tree == BASELINE { Some("1.00".to_owned()) } else { run.shown() };
    let mut cells = vec![tree_name(tree), shown(open)?, shown(withheld)?, format!("{:.2}", b / a)];
    for run in &runs {
        let worst = run.worst()?;
        cells.extend([format!("{:.2}", worst.value), worst.scene.clone()]);
    }
    Some(cells)
}
