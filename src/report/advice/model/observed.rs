//! What a run tells of each scene: the facts of its mesh, and the total times of its trees.

use super::facts::{BUILDER, SceneFacts};
use crate::bench::quick::line::TotalTime;
use crate::bench::quick::line::least_at;
use crate::bench::row::Row;
use crate::bench::statistics::geometric_mean;
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
    /// The same of the first round alone, and of all later ones; `None` where the times of rounds are not known.
    pub by_round: Option<[Vec<TotalTime>; 2]>,
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
            by_round: self.by_round.as_ref().map(|halves| halves.each_ref().map(some)),
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
        by_round: trees.iter().map(|&tree| halves(figures, tree)).collect::<Option<Vec<_>>>().map(|halves| {
            [0, 1].map(|half| halves.iter().map(|of_tree: &[TotalTime; 2]| of_tree[half]).collect())
        }),
    };
    known.iter().map(of).collect()
}

/// The total time of a tree, by its medians.
fn line(figures: &SceneFigures<'_>, tree: (&str, u32)) -> Option<TotalTime> {
    let traced = figures.trace(tree, KERNEL).value()?;
    let build = figures.build(tree).value()?.build_ms_median?;
    Some(TotalTime::exact(build, 1e6 * traced.trace_ms_median? / traced.rays? as f64))
}

/// The total time of a tree in the first round, and in the later ones.
fn halves(figures: &SceneFigures<'_>, tree: (&str, u32)) -> Option<[TotalTime; 2]> {
    let traced = figures.trace(tree, KERNEL).value()?;
    let rays = traced.rays? as f64;
    let mean = |times: &[(u32, f64)]| geometric_mean(&times.iter().map(|time| time.1).collect::<Vec<_>>());
    let of = |first: bool| {
        let part = |times: &[(u32, f64)]| if first { mean(times.get(..1)?) } else { mean(times.get(1..)?) };
        Some(TotalTime::exact(part(&traced.by_round.build)?, 1e6 * part(&traced.by_round.trace)? / rays))
    };
    Some([of(true)?, of(false)?])
}
