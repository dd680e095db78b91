//! The short table of the first page: a few trees relative to Embree SAH.

use super::figures::{BASELINE, Figure, Under, scenes, tree_name, tree_named};
use super::grid::Grid;
use super::means::Ratios;
use crate::bench::row::Row;

/// Geometric means of build time, trace time and SAH cost of the trees `names`, with the scene whose trace time is
/// worst.
///
/// # Errors
/// One line, if a tree has no such figure in `rows`.
pub fn summary(rows: &[Row], names: &[&str], under: &Under) -> Result<String, String> {
    let header = ["builder", "build time", "trace time", "worst trace", "in", "SAH cost"];
    let mut grid = Grid::new(header);
    for name in names {
        let cells = tree_named(name).and_then(|tree| {
            let ratios = |figure| Ratios::of(rows, tree, figure, under);
            let mean = |figure| Some(format!("{:.2}", ratios(figure).geometric()?));
            let (scene, worst) = ratios(Figure::Trace).worst()?.clone();
            // The baseline is 1 in every scene.
            let (worst, scene) =
                if tree == BASELINE { Default::default() } else { (format!("{worst:.2}"), scene) };
            let (build, trace, cost) = (mean(Figure::Build)?, mean(Figure::Trace)?, mean(Figure::Cost)?);
            Some(vec![tree_name(tree), build, trace, worst, scene, cost])
        });
        grid.push(
            cells.ok_or_else(|| {
                format!("the rows have no build, trace and cost of {name} beside Embree SAH")
            })?,
        );
    }
    let (scenes, threads) = (scenes(rows).len(), rows.first().map_or(0, |row| row.threads));
    Ok(format!(
        "{}\nRelative to Embree SAH: geometric means over {scenes} scenes, {threads} threads. Traces: {}.\n",
        grid.markdown(),
        under.about()
    ))
}
