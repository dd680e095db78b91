//! Ablation: builders relative to one of them, in the mean and scene by scene, to see the worth of each part.

use super::figures::{Figure, GRAFTED, PHR, SceneFigures, Under, scenes, tree_name, tree_named, trees};
use super::grid::Grid;
use super::means::Ratios;
use crate::bench::row::Row;

/// The compared figures, each with its kernel. Steps are exact; of traces only differences above their noise tell
/// anything.
fn figures() -> [(&'static str, Figure, Under); 6] {
    let (grafted, phr) = (Under::One(GRAFTED.into()), Under::One(PHR.into()));
    [
        ("build", Figure::Build, grafted.clone()),
        ("SAH cost", Figure::Cost, grafted.clone()),
        ("EPO", Figure::Overlap, grafted.clone()),
        ("steps", Figure::Steps, phr.clone()),
        ("trace", Figure::Trace, grafted),
        ("trace, phr", Figure::Trace, phr),
    ]
}

/// Builders relative to one of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ablation {
    means: Grid,
    scenes: Grid,
    legend: String,
}

impl Ablation {
    /// The trees `names` relative to `base`, all as [`tree_named`] reads them.
    ///
    /// # Errors
    /// One line, if the rows lack one of the trees.
    pub fn of(rows: &[Row], base: &str, names: &[&str]) -> Result<Self, String> {
        let known = trees(rows);
        let tree = |name| tree_named(name).filter(|tree| known.contains(tree));
        if let Some(unknown) = [base].iter().chain(names).find(|name| tree(name).is_none()) {
            let known: Vec<String> = known.into_iter().map(tree_name).collect();
            return Err(format!("the rows have no builder {unknown}; there are {}", known.join(", ")));
        }
        let base_tree = tree(base);
        let is_measured = |figure: Figure, under: &Under| {
            base_tree.is_some_and(|base| Ratios::to(base, rows, base, figure, under).geometric().is_some())
        };
        let mut columns = Vec::from(figures());
        columns.retain(|(_, figure, under)| is_measured(*figure, under));
        let header = |first: &str| {
            let header = [first.to_owned(), "scene".into()].into_iter();
            header.chain(columns.iter().map(|column| column.0.to_owned()))
        };
        let (mut means, mut each) = (Grid::new(header("mean")), Grid::new(header("builder")));
        for name in names {
            let line = |scene: String, ratio: &dyn Fn(Figure, &Under) -> Option<f64>| {
                let show =
                    |ratio: Option<f64>| ratio.map_or_else(|| "-".into(), |ratio| format!("{ratio:.3}"));
                let ratios = columns.iter().map(|(_, figure, under)| show(ratio(*figure, under)));
                [(*name).to_owned(), scene].into_iter().chain(ratios).collect::<Vec<_>>()
            };
            let (Some(base), Some(tree)) = (tree(base), tree(name)) else { continue };
            means.push(line(String::new(), &|figure, under| {
                Ratios::to(base, rows, tree, figure, under).geometric()
            }));
            for scene in scenes(rows) {
                let figures = SceneFigures::of(rows, &scene);
                each.push(line(scene, &|figure, under| {
                    Some(figures.ratio_to(base, tree, figure, under)?.value)
                }));
            }
        }
        let legend = format!(
            "Relative to {base}; geometric means over {} scenes or those with the figure. steps: nodes visited and \
             blocks tested by all recorded rays, exact. trace: the time of these rays under embree-grafted, and under \
             phr.\n",
            scenes(rows).len()
        );
        Ok(Self { means, scenes: each, legend })
    }

    /// For a terminal: the means, then every scene.
    pub fn text(&self) -> String {
        format!("{}\n{}\n{}", self.means.markdown(), self.scenes.markdown(), self.legend)
    }

    /// For a page: the means, with the scenes folded away.
    pub fn page(&self) -> String {
        let summary = "<details><summary>Every scene</summary>";
        let (means, scenes) = (self.means.markdown(), self.scenes.markdown());
        format!("{means}\n{}\n{summary}\n\n{scenes}\n</details>\n", self.legend)
    }
}
