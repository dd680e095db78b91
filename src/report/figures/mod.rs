//! The figures of a run by scene and tree: looked up among the rows, never mixing kernels silently, and
//! relative to Embree SAH.

pub mod interval;
mod place;
mod scenes;
mod under;

use crate::bench::cell::place;
use crate::bench::rounds::{ByRound, paired};
use crate::bench::row::{ALL, NO_KERNEL, REBUILD, Row};
use crate::bench::statistics::Summary;
use interval::{Noise, SceneRatio};
pub use place::Place;
pub use scenes::{scenes, scenes_of};
use std::collections::HashMap;
pub use under::{GRAFTED, NATIVE, OWN, PHR, Under, kernels};

/// A tree of the table: builder and width.
pub type Tree<'a> = (&'a str, u32);

/// The tree that all ratios are relative to.
pub const BASELINE: Tree<'static> = ("embree-sah", 4);
/// The width of the paper's trees.
pub const WIDTH: u32 = 4;

/// A copy of the rows that `keep` accepts.
pub fn only(rows: &[Row], keep: impl Fn(&Row) -> bool) -> Vec<Row> {
    rows.iter().filter(|row| keep(row)).cloned().collect()
}

/// The trees of `rows`, in the table's order.
pub fn trees<'a>(rows: impl IntoIterator<Item = &'a Row>) -> Vec<Tree<'a>> {
    let mut trees: Vec<Tree<'a>> = rows.into_iter().map(|row| (row.builder.as_str(), row.width)).collect();
    trees.sort_by(|a, b| (place(a.0), a).cmp(&(place(b.0), b)));
    trees.dedup();
    trees
}

/// Whether Embree SAH was built for a scene of `rows`: else there is nothing that ratios are relative to.
pub fn has_baseline(rows: &[Row]) -> bool {
    SceneFigures::all(rows).iter().any(|scene| scene.build(BASELINE).value().is_some())
}

/// A tree's name: the builder, with the width where it is not the paper's.
pub fn tree_name((builder, width): Tree<'_>) -> String {
    if width == WIDTH { builder.into() } else { format!("{builder} / {width}") }
}

/// The tree that `name` asks for: a builder, followed by the width where it is not the paper's (`embree-sah/8`).
pub fn tree_named(name: &str) -> Option<Tree<'_>> {
    match name.split_once('/') {
        None => Some((name, WIDTH)),
        Some((builder, width)) => Some((builder, width.parse().ok()?)),
    }
}

/// A figure of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Time of a fresh build.
    Build,
    /// Time of the first build of a new builder or device.
    First,
    /// Time of a build that reuses all it can.
    Rebuild,
    /// Time on processors of fresh builds, all threads together.
    BuildCpu,
    /// Instructions of fresh builds, all threads together.
    BuildInstructions,
    /// SAH cost.
    Cost,
    /// End-point overlap.
    Overlap,
    /// Time of the whole path-traced frame.
    Frame,
    /// Time for the recorded rays alone.
    Trace,
    /// Inner nodes visited and leaf blocks tested per ray under our kernel: what traces take, without noise.
    Steps,
}

/// The figures of one scene.
pub struct SceneFigures<'a> {
    scene: String,
    totals: Vec<&'a Row>,
    /// Views behind a figure that sums over all of them; `None` where the rows hold the sums alone.
    pub views: Option<usize>,
}

impl<'a> SceneFigures<'a> {
    /// The figures of `scene` among `rows`, from the rows with most threads.
    pub fn of(rows: &'a [Row], scene: &str) -> Self {
        Self::of_rows(scene, rows.iter().filter(|row| row.scene == scene).collect())
    }

    /// The figures of every scene, in the order of `rows`.
    pub fn all(rows: &'a [Row]) -> Vec<Self> {
        let mut places: HashMap<&str, usize> = HashMap::new();
        let mut by_scene: Vec<(&str, Vec<&Row>)> = Vec::new();
        for row in rows {
            let place = *places.entry(&row.scene).or_insert(by_scene.len());
            if place == by_scene.len() {
                by_scene.push((&row.scene, Vec::new()));
            }
            by_scene[place].1.push(row);
        }
        by_scene.into_iter().map(|(scene, rows)| Self::of_rows(scene, rows)).collect()
    }

    fn of_rows(scene: &str, mut rows: Vec<&'a Row>) -> Self {
        let threads = rows.iter().map(|row| row.threads).max();
        rows.retain(|row| Some(row.threads) == threads);
        let mut views: Vec<&str> =
            rows.iter().map(|row| row.view.as_str()).filter(|&view| view != ALL).collect();
        views.sort_unstable();
        views.dedup();
        let views = Some(views.len()).filter(|&views| views > 0);
        rows.retain(|row| row.is_total());
        Self { scene: scene.into(), totals: rows, views }
    }

    /// By what traces of `scenes` are compared: whole frames, as in the paper, if all that was traced under the kernels
    /// compared has them, so that a figure means one thing.
    pub fn traced_by<'s>(scenes: impl IntoIterator<Item = &'s Self>, under: &Under) -> Figure
    where
        'a: 's,
    {
        let has_frames = |row: &&Row| {
            row.trace_ms_median.is_none() || row.frame_ms_median.is_some() || !under.compares(row)
        };
        let all = scenes.into_iter().all(|scene| scene.totals.iter().all(has_frames));
        if all { Figure::Frame } else { Figure::Trace }
    }

    /// Name of the scene.
    pub fn scene(&self) -> &str {
        &self.scene
    }

    /// Rows that sum over views and kinds of rays.
    pub fn totals(&self) -> &[&'a Row] {
        &self.totals
    }

    /// Triangles of the scene.
    pub fn triangles(&self) -> u64 {
        self.totals.first().map_or(0, |row| row.triangles)
    }

    fn of_tree(&self, (builder, width): Tree<'_>) -> impl Iterator<Item = &'a Row> {
        self.totals.iter().copied().filter(move |r| r.builder == builder && r.width == width)
    }

    /// The rows of a tree in the regime by which builders are compared.
    fn compared(&self, tree: Tree<'_>) -> impl Iterator<Item = &'a Row> {
        self.of_tree(tree).filter(|row| row.is_compared())
    }

    /// A row that tells of a tree's builds: any but one of wrong hits.
    pub fn build(&self, tree: Tree<'_>) -> Place<&'a Row> {
        let told = |row: &&Row| row.build_ms_median.is_some() && row.verified != Some(false);
        match self.compared(tree).find(told) {
            Some(row) => Place::Value(row),
            None if self.compared(tree).any(|row| !row.error.is_empty() && !row.is_unavailable()) => {
                Place::Failed
            }
            None => Place::Missing,
        }
    }

    /// The row of a tree's first builds.
    pub fn first(&self, tree: Tree<'_>) -> Option<&'a Row> {
        self.of_tree(tree).find(|row| row.is_first())
    }

    /// The row of a tree's builds that reuse all they can.
    pub fn rebuild(&self, tree: Tree<'_>) -> Option<&'a Row> {
        self.of_tree(tree).find(|row| row.regime == REBUILD)
    }

    /// The row of a tree under `kernel`.
    pub fn trace(&self, tree: Tree<'_>, kernel: &str) -> Place<&'a Row> {
        let rows = || self.compared(tree).filter(|row| row.kernel == kernel || row.kernel == NO_KERNEL);
        match rows().find(|row| row.is_good() && row.trace_ms_median.is_some()) {
            Some(row) => Place::Value(row),
            None if rows().any(|row| !row.is_good() && !row.is_unavailable()) => Place::Failed,
            None => Place::Missing,
        }
    }

    /// A figure of a tree; times with their spread, but for processors' time and instructions, whose rounds are not
    /// kept; costs and steps have none.
    pub fn figure(&self, tree: Tree<'_>, figure: Figure, under: &Under) -> Place<Summary> {
        let traced = || self.trace(tree, under.kernel_of(tree.0));
        match figure {
            Figure::Build => self.build(tree).and_then(Row::build_ms),
            Figure::First => self.first(tree).and_then(Row::build_ms).map_or(Place::Missing, Place::Value),
            Figure::Rebuild => {
                self.rebuild(tree).and_then(Row::build_ms).map_or(Place::Missing, Place::Value)
            }
            Figure::BuildCpu => self.build(tree).and_then(|row| row.build_cpu_ns_per_tri.map(exact)),
            Figure::BuildInstructions => {
                self.build(tree).and_then(|row| row.build_instructions_per_tri.map(exact))
            }
            Figure::Cost => self.build(tree).and_then(|row| row.sah.map(exact)),
            Figure::Overlap => self.build(tree).and_then(|row| row.epo.map(exact)),
            Figure::Frame => traced().and_then(Row::frame_ms),
            Figure::Trace => traced().and_then(Row::trace_ms),
            Figure::Steps => self.trace(tree, PHR).and_then(|row| row.steps().map(exact)),
        }
    }

    /// A figure of a tree relative to Embree SAH, see [`SceneFigures::ratio_to`].
    pub fn ratio(&self, tree: Tree<'_>, figure: Figure, under: &Under) -> Option<SceneRatio> {
        self.ratio_to(BASELINE, tree, figure, under)
    }

    /// A figure of a tree relative to that of `base`, which is taken under the same choice of kernel, with what is
    /// known of its noise: from times of the same rounds where the rows have them. `None` too where `base` has no
    /// figure: a ratio to nothing is none.
    pub fn ratio_to(
        &self,
        base: Tree<'_>,
        tree: Tree<'_>,
        figure: Figure,
        under: &Under,
    ) -> Option<SceneRatio> {
        let of = |tree| self.figure(tree, figure, under).value();
        let (a, b) = (of(tree)?, of(base).filter(|b| b.median > 0.0)?);
        let scene = self.scene.clone();
        if tree == base {
            return Some(SceneRatio { scene, value: 1.0, noise: Noise::NONE });
        }
        let rounds = |tree| self.rounds(tree, figure, under);
        let of_one_run = rounds(tree).zip(rounds(base)).filter(|(a, b)| a.0 == b.0);
        let noise = Noise::of(&a, &b, of_one_run.map(|(a, b)| paired(a.1, b.1)).unwrap_or_default());
        Some(SceneRatio { scene, value: a.median / b.median, noise })
    }

    /// The run behind a figure and its times by round; costs have none.
    pub fn rounds(&self, tree: Tree<'_>, figure: Figure, under: &Under) -> Option<(&'a str, &'a ByRound)> {
        let traced = || self.trace(tree, under.kernel_of(tree.0)).value();
        let (row, times) = match figure {
            Figure::Build => self.build(tree).value().map(|row| (row, &row.by_round.build)),
            Figure::First => self.first(tree).map(|row| (row, &row.by_round.build)),
            Figure::Rebuild => self.rebuild(tree).map(|row| (row, &row.by_round.build)),
            Figure::Frame => traced().map(|row| (row, &row.by_round.frame)),
            Figure::Trace => traced().map(|row| (row, &row.by_round.trace)),
            Figure::BuildCpu | Figure::BuildInstructions | Figure::Cost | Figure::Overlap | Figure::Steps => {
                None
            }
        }?;
        Some((&row.run_id, times))
    }
}

fn exact(value: f64) -> Summary {
    Summary { count: usize::MAX, median: value, mad: 0.0, min: value, max: value }
}
