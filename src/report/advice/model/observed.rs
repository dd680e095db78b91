//! What a run tells of each scene: the facts of its mesh, and the total times of its trees.

use super::facts::{BUILDER, SceneFacts};
use crate::bench::quick::line::TotalTime;
use crate::bench::quick::line::least_at;
use crate::bench::row::Row;
use crate::report::figures::{GRAFTED, SceneFigures, WIDTH, scenes, trees};

/// The kernel under which all trees compare.
pub const KERNEL: &str = GRAFTED;

/// A tree: builder and width.
pub type TreeName = (String, u32);

/// A scene of a run.
#[derive(Clone, Debug)]
pub struct Observed {
    /// The scene.
    pub scene: String,
    /// Facts of its mesh.
    pub facts: SceneFacts,
    /// The trees, the same in all scenes.
    pub trees: Vec<TreeName>,
    /// The total time of each.
    pub lines: Vec<TotalTime>,
    /// The same in each round; none where the times of rounds are not known of all trees.
    pub by_round: Vec<Vec<TotalTime>>,
}

impl Observed {
    /// How much more than the best a tree takes for so many rays: 1 for the best.
    pub fn ratio(&self, tree: usize, rays: f64) -> f64 {
        self.lines[tree].at(rays) / self.lines[self.best(rays)].at(rays)
    }

    /// The best tree for so many rays.
    pub fn best(&self, rays: f64) -> usize {
        least_at(&self.lines, rays).unwrap_or_default()
    }

    /// Only some trees, by index.
    pub fn only(&self, keep: &[usize]) -> Self {
        let some = |lines: &Vec<TotalTime>| keep.iter().map(|&i| lines[i]).collect::<Vec<_>>();
        Self {
            trees: keep.iter().map(|&i| self.trees[i].clone()).collect(),
            lines: some(&self.lines),
            by_round: self.by_round.iter().map(some).collect(),
            ..self.clone()
        }
    }
}

/// The scenes of a run that have facts, with the trees that every one of them has.
pub fn observed(rows: &[Row]) -> Vec<Observed> {
    let names = scenes(rows);
    let figures: Vec<SceneFigures<'_>> = names.iter().map(|name| SceneFigures::of(rows, name)).collect();
    let facts = |figures: &SceneFigures<'_>| SceneFacts::of_row(figures.build((BUILDER, WIDTH)).value()?);
    let known: Vec<(&String, &SceneFigures<'_>, SceneFacts)> = names
        .iter()
        .zip(&figures)
        .filter_map(|(name, figures)| Some((name, figures, facts(figures)?)))
        .collect();
    let mut trees = trees(rows);
    trees.retain(|&tree| known.iter().all(|(_, figures, _)| line(figures, tree).is_some()));
    let of = |(name, figures, facts): &(&String, &SceneFigures<'_>, SceneFacts)| Observed {
        scene: (*name).clone(),
        facts: *facts,
        trees: trees.iter().map(|(builder, width)| ((*builder).to_owned(), *width)).collect(),
        lines: trees.iter().filter_map(|&tree| line(figures, tree)).collect(),
        by_round: by_round(
            &trees.iter().filter_map(|&tree| rounds(figures, tree)).collect::<Vec<_>>(),
            trees.len(),
        ),
    };
    known.iter().map(of).collect()
}

/// The total time of a tree, by its medians.
fn line(figures: &SceneFigures<'_>, tree: (&str, u32)) -> Option<TotalTime> {
    let traced = figures.trace(tree, KERNEL).value()?;
    let build = figures.build(tree).value()?.build_ms_median?;
    Some(TotalTime::exact(build, 1e6 * traced.trace_ms_median? / traced.rays? as f64))
}

/// The total time of a tree in each round.
fn rounds(figures: &SceneFigures<'_>, tree: (&str, u32)) -> Option<Vec<TotalTime>> {
    let traced = figures.trace(tree, KERNEL).value()?;
    let rays = traced.rays? as f64;
    let times = traced.by_round.build.iter().zip(&traced.by_round.trace);
    Some(times.map(|(build, trace)| TotalTime::exact(build.1, 1e6 * trace.1 / rays)).collect())
}

/// The rounds in which all of so many trees were measured, from the rounds of each tree.
fn by_round(of_trees: &[Vec<TotalTime>], trees: usize) -> Vec<Vec<TotalTime>> {
    let count = of_trees.iter().map(Vec::len).min().filter(|_| of_trees.len() == trees).unwrap_or_default();
    (0..count).map(|round| of_trees.iter().map(|rounds| rounds[round]).collect()).collect()
}
