//! How often each tree is on the Pareto front of build and trace time: beaten by no other in both.

use crate::bench::cell::is_saved;
use crate::bench::row::Row;
use crate::report::figures::{self, Figure, SceneFigures, Tree, Under, scenes, tree_name};
use crate::report::grid::Grid;
use crate::report::plot::pareto::front;

/// Rows under a name, such as those of the open and those of the withheld scenes.
pub type Named<'a> = (&'a str, &'a [Row]);

/// Number of scenes in which each tree is on the front: among the trees of its width and among those of both
/// widths, all under the fairest kernel; and among those of both widths, each engine's under its own kernel.
/// Columns for each of `runs`, a dash for a tree that it lacks.
pub fn fronts(runs: &[Named<'_>]) -> String {
    let header = runs.iter().flat_map(|(name, _)| {
        ["same width", "both widths", "own kernels"].map(|column| format!("{name}: {column}"))
    });
    let mut grid = Grid::new(["tree".to_owned()].into_iter().chain(header));
    let mut all: Vec<Tree<'_>> = Vec::new();
    for tree in runs.iter().flat_map(|(_, rows)| trees(rows)) {
        if !all.contains(&tree) {
            all.push(tree);
        }
    }
    for &tree in &all {
        let cells = runs.iter().flat_map(|(_, rows)| {
            if !trees(rows).contains(&tree) {
                return ["-", "-", "-"].map(str::to_owned);
            }
            let best = Under::best(rows);
            let is_rival: [(&Under, bool); 3] = [(&best, true), (&best, false), (&Under::Own, false)];
            is_rival.map(|(under, same_width)| {
                let is_on = |scene: &String| is_on_front(rows, scene, tree, under, same_width);
                scenes(rows).iter().filter(|scene| is_on(scene)).count().to_string()
            })
        });
        grid.push([tree_name(tree)].into_iter().chain(cells).collect());
    }
    let counts = runs.iter().map(|(name, rows)| format!("{} {name}", scenes(rows).len()));
    format!("{}\nNumbers of scenes, of {}.\n", grid.markdown(), counts.collect::<Vec<_>>().join(" and "))
}

/// The trees that were built; saved ones were loaded.
fn trees(rows: &[Row]) -> Vec<Tree<'_>> {
    figures::trees(rows).into_iter().filter(|tree| !is_saved(tree.0)).collect()
}

/// True if no tree of the scene, or of `tree`'s width there, builds and traces as fast as `tree`.
fn is_on_front(rows: &[Row], scene: &str, tree: Tree<'_>, under: &Under, same_width: bool) -> bool {
    let figures = SceneFigures::of(rows, scene);
    let at = |tree| {
        let ratio = |figure| Some(figures.ratio(tree, figure, under)?.value);
        Some((ratio(Figure::Build)?, ratio(Figure::Trace)?))
    };
    let rivals: Vec<(Tree<'_>, (f64, f64))> = trees(rows)
        .into_iter()
        .filter(|rival| !same_width || rival.1 == tree.1)
        .filter_map(|rival| Some((rival, at(rival)?)))
        .collect();
    let points: Vec<(f64, f64)> = rivals.iter().map(|rival| rival.1).collect();
    front(&points).into_iter().any(|on| rivals[on].0 == tree)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figures::{NATIVE, PHR};

    #[test]
    fn a_tree_is_judged_within_its_width_and_over_both() {
        let rows = [
            Row::by_hand("embree-sah", 4, NATIVE, 10.0, 10.0),
            Row::by_hand("embree-sah", 8, NATIVE, 11.0, 6.0),
            Row::by_hand("phr-hq", 4, PHR, 9.0, 7.0),
        ];
        let text = fronts(&[("open", &rows), ("withheld", &rows[..2])]);
        let cells = |name: &str| {
            let line = text.lines().find(|line| line.starts_with(&format!("| {name} "))).unwrap();
            line.split('|').map(str::trim).filter(|cell| !cell.is_empty()).collect::<Vec<_>>()
        };
        assert!(text.contains("Numbers of scenes, of 1 open and 1 withheld."), "{text}");
        assert_eq!(cells("embree-sah"), ["embree-sah", "0", "0", "0", "1", "1", "1"]);
        assert_eq!(cells("embree-sah / 8")[1..], ["1", "1", "1", "1", "1", "1"]);
        assert_eq!(cells("phr-hq"), ["phr-hq", "1", "1", "1", "-", "-", "-"]);
    }
}
