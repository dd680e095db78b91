//! Means over scenes of the figures relative to Embree SAH, beside the paper's: arithmetic as in its
//! Figure 6, and geometric, which is the right one for ratios. The worst scene is named.

use super::figures::{
    BASELINE, Figure, NATIVE, OWN, SceneFigures, Tree, Under, kernels, scenes, tree_name, trees,
};
use super::grid::Grid;
use super::paper;
use crate::bench::row::Row;
use crate::bench::statistics::{arithmetic_mean, geometric_mean};

/// Ratios of one tree with their scenes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ratios(pub Vec<(String, f64)>);

impl Ratios {
    /// The ratios of a run to Embree SAH, see [`Ratios::to`].
    pub fn of(rows: &[Row], tree: Tree<'_>, figure: Figure, under: &Under) -> Self {
        Self::to(BASELINE, rows, tree, figure, under)
    }

    /// The ratios of a run to `base`, without scenes that lack the figure of either tree.
    pub fn to(base: Tree<'_>, rows: &[Row], tree: Tree<'_>, figure: Figure, under: &Under) -> Self {
        let ratio =
            |name: &str| Some(SceneFigures::of(rows, name).ratio_to(base, tree, figure, under)?.value);
        Self(scenes(rows).into_iter().filter_map(|name| ratio(&name).map(|value| (name, value))).collect())
    }

    /// The ratios in the paper.
    pub fn of_paper(builder: &str, figure: Figure) -> Self {
        Self(paper::ratios(builder, figure))
    }

    fn values(&self) -> Vec<f64> {
        self.0.iter().map(|ratio| ratio.1).collect()
    }

    /// As in the paper's Figure 6.
    pub fn arithmetic(&self) -> Option<f64> {
        arithmetic_mean(&self.values())
    }

    /// The mean for ratios.
    pub fn geometric(&self) -> Option<f64> {
        geometric_mean(&self.values())
    }

    /// The least, with its scene.
    pub fn least(&self) -> Option<&(String, f64)> {
        self.0.iter().reduce(|least, other| if other.1 < least.1 { other } else { least })
    }

    /// The greatest, with its scene.
    pub fn worst(&self) -> Option<&(String, f64)> {
        self.0.iter().reduce(|worst, other| if other.1 > worst.1 { other } else { worst })
    }
}

/// The tables of means: build time, cost, frame and trace time; nothing without Embree SAH.
pub fn means(rows: &[Row], under: &Under) -> String {
    let sections = [
        ("Build time", Figure::Build),
        ("Build time, all memory reused", Figure::Rebuild),
        ("SAH cost", Figure::Cost),
        ("Frame time", Figure::Frame),
        ("Trace time, recorded rays", Figure::Trace),
    ];
    let mut text = String::new();
    for (title, figure) in sections {
        let grid = table(rows, figure, under);
        if grid.is_empty() {
            continue;
        }
        let traced = matches!(figure, Figure::Frame | Figure::Trace);
        let under = if traced { format!(": {}", under.about()) } else { String::new() };
        text += &format!("### {title}{under}\n\n{}\n", grid.markdown());
    }
    if text.is_empty() {
        return text;
    }
    format!(
        "## Means relative to Embree SAH at width 4\n\n{text}{}{}",
        by_kernel(rows),
        "arith.: arithmetic mean, as in the paper's Figure 6. geo.: geometric mean. paper: the same mean over \
         the paper's nine scenes, 16 threads, Embree 2.11; its trace time is that of frames.\n"
    )
}

fn show(value: Option<f64>) -> String {
    value.map_or_else(|| "-".into(), |value| format!("{value:.3}"))
}

fn table(rows: &[Row], figure: Figure, under: &Under) -> Grid {
    let mut grid = Grid::new(["method", "arith.", "paper", "geo.", "paper", "worst", "in", "scenes"]);
    for tree in trees(rows) {
        let ratios = Ratios::of(rows, tree, figure, under);
        let Some((scene, worst)) = ratios.worst() else { continue };
        // The paper's trees are all four wide.
        let paper =
            if tree_name(tree) == tree.0 { Ratios::of_paper(tree.0, figure) } else { Ratios::default() };
        grid.push(vec![
            tree_name(tree),
            show(ratios.arithmetic()),
            show(paper.arithmetic()),
            show(ratios.geometric()),
            show(paper.geometric()),
            format!("{worst:.2}"),
            scene.clone(),
            ratios.0.len().to_string(),
        ]);
    }
    grid
}

/// Does the ranking of the trees depend on the kernel? Geometric means of trace times under each kernel that
/// traced Embree SAH too; empty unless there are two choices.
fn by_kernel(rows: &[Row]) -> String {
    // Embree's native kernel is part of the column in which each tree has its own.
    let mut choices: Vec<Under> = kernels(rows)
        .into_iter()
        .filter(|kernel| kernel != NATIVE)
        .map(Under::One)
        .chain([Under::Own])
        .collect();
    let mean = |tree, under: &Under| Ratios::of(rows, tree, Figure::Trace, under).geometric();
    choices.retain(|under| {
        trees(rows).into_iter().any(|tree| mean(tree, under).is_some_and(|mean| mean != 1.0))
    });
    if choices.len() < 2 {
        return String::new();
    }
    let name =
        |under: &Under| if under.name() == OWN { "each its own".to_owned() } else { under.name().to_owned() };
    let mut grid = Grid::new(["method".to_owned()].into_iter().chain(choices.iter().map(name)));
    for tree in trees(rows) {
        let cells = choices.iter().map(|under| show(mean(tree, under)));
        grid.push([tree_name(tree)].into_iter().chain(cells).collect());
    }
    format!("### Trace time by kernel, geometric means\n\n{}\n", grid.markdown())
}
