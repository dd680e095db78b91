//! The figures of a run by scene and tree: looked up among the rows, never mixing kernels silently, and
//! relative to Embree SAH.

pub mod interval;
mod place;
mod scenes;

use crate::bench::cell::place;
use crate::bench::rounds::{ByRound, paired};
use crate::bench::row::{ALL, NO_KERNEL, REBUILD, Row};
use crate::bench::statistics::{Ratio, Summary};
use interval::{Noise, SceneRatio};
pub use place::Place;
pub use scenes::{scenes, scenes_of};

/// A tree of the table: builder and width.
pub type Tree<'a> = (&'a str, u32);

/// The tree that all ratios are relative to.
pub const BASELINE: Tree<'static> = ("embree-sah", 4);
/// The width of the paper's trees.
pub const WIDTH: u32 = 4;

/// Every tree in Embree's node layout under Embree's kernel.
pub const GRAFTED: &str = "embree-grafted";
/// Embree's trees as Embree built them, under its kernel.
pub const NATIVE: &str = "embree-native";
/// Our kernel.
pub const PHR: &str = "phr";
/// Each tree under the kernel of whoever built it.
pub const OWN: &str = "own";

/// Under which kernel traces are compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Under {
    /// All trees under one kernel, of this name.
    One(String),
    /// Embree's trees under [`NATIVE`], ours under [`PHR`]: tree and kernel are compared together.
    Own,
}

impl Under {
    /// The fairest choice: [`GRAFTED`] if the run has it, else each tree under its own kernel.
    pub fn best(rows: &[Row]) -> Self {
        if kernels(rows).iter().any(|kernel| kernel == GRAFTED) {
            Self::One(GRAFTED.into())
        } else {
            Self::Own
        }
    }

    /// The choice called `name`, if `rows` have figures for it.
    ///
    /// # Errors
    /// One line that lists the known names.
    pub fn by_name(name: &str, rows: &[Row]) -> Result<Self, String> {
        let known = kernels(rows);
        if name == OWN {
            Ok(Self::Own)
        } else if known.iter().any(|kernel| kernel == name) {
            Ok(Self::One(name.into()))
        } else {
            Err(format!(
                "--kernel {name}: no traces under it; there are {}",
                [&known[..], &[OWN.into()]].concat().join(", ")
            ))
        }
    }

    /// The name on the command line.
    pub fn name(&self) -> &str {
        match self {
            Self::One(kernel) => kernel,
            Self::Own => OWN,
        }
    }

    /// The kernel under which trees of `builder` are traced.
    pub fn kernel_of(&self, builder: &str) -> &str {
        match self {
            Self::One(kernel) => kernel,
            Self::Own if builder.starts_with("embree-") => NATIVE,
            Self::Own => PHR,
        }
    }

    /// The choice in words, for a legend.
    pub fn about(&self) -> String {
        match self {
            Self::One(kernel) if kernel == GRAFTED => {
                "all trees in Embree's node layout under Embree's kernel (embree-grafted)".into()
            }
            Self::One(kernel) => format!("all trees under the kernel {kernel}"),
            Self::Own => {
                "Embree's trees under embree-native, ours under phr: tree and kernel together".into()
            }
        }
    }
}

/// Kernels with figures, the most comparable first.
pub fn kernels<'a>(rows: impl IntoIterator<Item = &'a Row>) -> Vec<String> {
    let order = |name: &str| [GRAFTED, NATIVE, PHR].iter().position(|known| *known == name).unwrap_or(3);
    let traced = rows.into_iter().filter(|row| row.is_good() && row.trace_ms_median.is_some());
    let mut names: Vec<String> = traced.map(|row| row.kernel.clone()).collect();
    names.sort_by(|a, b| (order(a), a).cmp(&(order(b), b)));
    names.dedup();
    names
}

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
    /// Time of a build that reuses all it can.
    Rebuild,
    /// Time on processors of fresh builds, all threads together.
    BuildCpu,
    /// SAH cost.
    Cost,
    /// End-point overlap.
    Overlap,
    /// Time of the whole path-traced frame.
    Frame,
    /// Time for the recorded rays alone.
    Trace,
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
        let threads = rows.iter().filter(|row| row.scene == scene).map(|row| row.threads).max();
        let of_scene = || rows.iter().filter(|row| row.scene == scene && Some(row.threads) == threads);
        let mut views: Vec<&str> =
            of_scene().map(|row| row.view.as_str()).filter(|&view| view != ALL).collect();
        views.sort_unstable();
        views.dedup();
        let views = Some(views.len()).filter(|&views| views > 0);
        Self { scene: scene.into(), totals: of_scene().filter(|row| row.is_total()).collect(), views }
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
            None if self.compared(tree).any(|row| !row.error.is_empty()) => Place::Failed,
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
            None if rows().any(|row| !row.is_good()) => Place::Failed,
            None => Place::Missing,
        }
    }

    /// A figure of a tree; times with their spread, costs without any.
    pub fn figure(&self, tree: Tree<'_>, figure: Figure, under: &Under) -> Place<Summary> {
        let traced = || self.trace(tree, under.kernel_of(tree.0));
        match figure {
            Figure::Build => self.build(tree).and_then(Row::build_ms),
            Figure::Rebuild => {
                self.rebuild(tree).and_then(Row::build_ms).map_or(Place::Missing, Place::Value)
            }
            Figure::BuildCpu => self.build(tree).and_then(|row| row.build_cpu_ns_per_tri.map(exact)),
            Figure::Cost => self.build(tree).and_then(|row| row.sah.map(exact)),
            Figure::Overlap => self.build(tree).and_then(|row| row.epo.map(exact)),
            Figure::Frame => traced().and_then(Row::frame_ms),
            Figure::Trace => traced().and_then(Row::trace_ms),
        }
    }

    /// A figure of a tree relative to Embree SAH, see [`SceneFigures::ratio_to`].
    pub fn ratio(&self, tree: Tree<'_>, figure: Figure, under: &Under) -> Option<Ratio> {
        self.ratio_to(BASELINE, tree, figure, under)
    }

    /// A figure of a tree relative to that of `base`, which is taken under the same choice of kernel. `None`
    /// too where that has none: a ratio to nothing is no figure.
    pub fn ratio_to(&self, base: Tree<'_>, tree: Tree<'_>, figure: Figure, under: &Under) -> Option<Ratio> {
        let of = |tree| self.figure(tree, figure, under).value();
        let (a, b) = (of(tree)?, of(base).filter(|b| b.median > 0.0)?);
        Some(if tree == base { Ratio { value: 1.0, low: 1.0, high: 1.0 } } else { Ratio::propagated(&a, &b) })
    }

    /// The ratio of [`SceneFigures::ratio_to`] with what is known of its noise: from times of the same rounds where the
    /// rows have them.
    pub fn noisy_ratio_to(
        &self,
        base: Tree<'_>,
        tree: Tree<'_>,
        figure: Figure,
        under: &Under,
    ) -> Option<SceneRatio> {
        let (scene, value) = (self.scene.clone(), self.ratio_to(base, tree, figure, under)?.value);
        if tree == base {
            return Some(SceneRatio { scene, value, noise: Noise::NONE });
        }
        let of = |tree| Some((self.figure(tree, figure, under).value()?, self.rounds(tree, figure, under)));
        let ((a, a_rounds), (b, b_rounds)) = (of(tree)?, of(base)?);
        let of_one_run = a_rounds.zip(b_rounds).filter(|(a, b)| a.0 == b.0);
        let noise = Noise::of(&a, &b, of_one_run.map(|(a, b)| paired(a.1, b.1)).unwrap_or_default());
        Some(SceneRatio { scene, value, noise })
    }

    /// The run behind a figure and its times by round; costs have none.
    fn rounds(&self, tree: Tree<'_>, figure: Figure, under: &Under) -> Option<(&'a str, &'a ByRound)> {
        let traced = || self.trace(tree, under.kernel_of(tree.0)).value();
        let (row, times) = match figure {
            Figure::Build => self.build(tree).value().map(|row| (row, &row.by_round.build)),
            Figure::Rebuild => self.rebuild(tree).map(|row| (row, &row.by_round.build)),
            Figure::Frame => traced().map(|row| (row, &row.by_round.frame)),
            Figure::Trace => traced().map(|row| (row, &row.by_round.trace)),
            Figure::BuildCpu | Figure::Cost | Figure::Overlap => None,
        }?;
        Some((&row.run_id, times))
    }
}

fn exact(value: f64) -> Summary {
    Summary { count: usize::MAX, median: value, mad: 0.0, min: value, max: value }
}
