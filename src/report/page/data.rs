//! The figures of the page, each from the code that makes tables and plots of them; the page shows them and
//! computes none.

use super::family::family_of;
use crate::bench::cell::is_saved;
use crate::bench::row::Row;
use crate::report::figures::interval::SceneRatio;
use crate::report::figures::{Figure, NATIVE, PHR, Place, SceneFigures, Tree, Under, kernels, tree_name};
use crate::report::plot::pareto::front;
use crate::report::verdict::field::Field;
use crate::report::verdict::totals::{budgets, totals};
use rayon::prelude::*;
use serde::Serialize;

/// Regimes of builds, the compared one first.
const REGIMES: [(Figure, &str, &str); 3] = [
    (Figure::Build, "fresh", "warm threads, new memory"),
    (Figure::First, "first", "a new builder or device"),
    (Figure::Rebuild, "rebuild", "all memory reused"),
];
/// Numbers of rays per power of ten at which curves of total time are told.
const CURVE: i32 = 4;

/// All of them.
#[derive(Debug, Serialize)]
pub struct Data {
    /// What ratios are relative to: builder and width.
    pub base: String,
    /// Its place among the trees.
    base_tree: Option<usize>,
    trees: Vec<TreeData>,
    /// Choices of kernel, the fairest first.
    pub kernels: Vec<Named>,
    /// Regimes of builds.
    pub regimes: Vec<Named>,
    /// The mean over scenes, where there are two, and each scene.
    pub places: Vec<PlaceData>,
    budgets: Vec<f64>,
    /// Mean total time relative to the base's at each of the budgets, by kernel, regime and tree.
    curves: Vec<Vec<Vec<Option<Vec<f64>>>>>,
}

/// A name with its meaning.
#[derive(Debug, Serialize)]
pub struct Named {
    name: String,
    about: String,
}

#[derive(Debug, Serialize)]
struct TreeData {
    name: String,
    width: u32,
    family: &'static str,
    shape: &'static str,
    is_saved: bool,
}

/// A scene, or the mean over scenes.
#[derive(Debug, Serialize)]
pub struct PlaceData {
    /// Its name.
    pub name: String,
    triangles: Option<u64>,
    /// Scenes behind it.
    scenes: usize,
    /// One for each tree; none where the scene lacks the tree.
    entries: Vec<Option<Entry>>,
    /// Places of trees in the list of all: the front over both widths, and those of 4-wide and 8-wide trees, by kernel
    /// and regime.
    fronts: Vec<Vec<[Vec<usize>; 3]>>,
}

/// A time with its ratio to the base's: ms, ratio, and the ends of its 95 % interval.
type Timed = [Option<f64>; 4];

#[derive(Debug, Serialize)]
struct Entry {
    /// By regime.
    builds: Vec<Option<Timed>>,
    /// SAH cost and its ratio.
    cost: Option<Timed>,
    /// By kernel.
    traces: Vec<Option<Timed>>,
    /// Million rays per second, by kernel.
    speeds: Vec<Option<f64>>,
    /// Rays traced, by kernel.
    rays: Option<u64>,
    /// Bytes at the peak of the build, per triangle.
    peak: Option<f64>,
    /// Scenes behind a mean, where they are not all, by kernel and regime; nothing in a scene.
    scenes: Vec<Vec<Option<usize>>>,
    /// Why figures are missing.
    error: Option<String>,
}

impl Data {
    /// The figures of `rows`.
    pub fn of(rows: &[Row], field: &Field<'_>) -> Self {
        let unders = unders(rows);
        let regimes: Vec<(Figure, &str, &str)> =
            REGIMES.into_iter().filter(|regime| has(field, regime.0)).collect();
        let shape =
            Shape { field, unders: &unders, regimes: regimes.iter().map(|regime| regime.0).collect() };
        let mean = (field.scenes.len() > 1).then(|| shape.mean());
        let scenes: Vec<PlaceData> = field.scenes.par_iter().map(|scene| shape.scene(scene)).collect();
        Self {
            base: format!("{}, {}-wide", field.base.0, field.base.1),
            base_tree: field.trees.iter().position(|&tree| tree == field.base),
            trees: field.trees.iter().map(|&tree| TreeData::of(tree)).collect(),
            kernels: unders.iter().map(Named::of).collect(),
            regimes: regimes
                .iter()
                .map(|(_, name, about)| Named { name: (*name).into(), about: (*about).into() })
                .collect(),
            places: mean.into_iter().chain(scenes).collect(),
            budgets: budgets(CURVE),
            curves: unders.par_iter().map(|under| shape.curves(under)).collect(),
        }
    }
}

/// The choices of kernel: the fairest, the others, and each tree's own where that is another choice.
fn unders(rows: &[Row]) -> Vec<Under> {
    let kernels = kernels(rows);
    let has_both = [NATIVE, PHR].iter().all(|&name| kernels.iter().any(|kernel| kernel == name));
    // Under a kernel that has Embree's trees alone there is little to choose.
    let mut all: Vec<Under> = kernels.into_iter().map(Under::One).collect();
    if has_both {
        all.push(Under::Own);
    }
    let best = Under::best(rows);
    all.sort_by_key(|under| *under != best);
    if all.is_empty() { vec![Under::Own] } else { all }
}

fn has(field: &Field<'_>, regime: Figure) -> bool {
    let has = |scene: &SceneFigures<'_>, tree| scene.figure(tree, regime, &Under::Own).value().is_some();
    regime == Figure::Build
        || field.scenes.iter().any(|scene| field.trees.iter().any(|&tree| has(scene, tree)))
}

impl Named {
    fn of(under: &Under) -> Self {
        Self { name: under.name().into(), about: under.about() }
    }
}

impl TreeData {
    fn of(tree: Tree<'_>) -> Self {
        let family = family_of(tree.0);
        let (name, is_saved) = (tree_name(tree), is_saved(tree.0));
        Self { name, width: tree.1, family: family.name, shape: family.shape, is_saved }
    }
}

/// What every place has: kernels and regimes.
struct Shape<'a> {
    field: &'a Field<'a>,
    unders: &'a [Under],
    regimes: Vec<Figure>,
}

impl Shape<'_> {
    fn mean(&self) -> PlaceData {
        let entries: Vec<Option<Entry>> =
            self.field.trees.par_iter().map(|&tree| self.mean_of(tree)).collect();
        let count = self.field.scenes.len();
        let name = format!("mean over {count} scenes");
        PlaceData { name, triangles: None, scenes: count, fronts: self.fronts(&entries), entries }
    }

    fn mean_of(&self, tree: Tree<'_>) -> Option<Entry> {
        let timed = |figure, under: &Under| {
            let ratios = self.field.ratios(tree, figure, under);
            let interval = ratios.interval(ratios.over()).filter(|interval| interval.high.is_finite());
            let [low, high] = [interval.map(|x| x.low), interval.map(|x| x.high)];
            Some((
                ratios.0.len(),
                [None, Some(rounded(ratios.geometric()?)), low.map(rounded), high.map(rounded)],
            ))
        };
        let builds: Vec<Option<(usize, Timed)>> =
            self.regimes.iter().map(|&regime| timed(regime, &Under::Own)).collect();
        let traces: Vec<Option<(usize, Timed)>> =
            self.unders.iter().map(|under| timed(Figure::Trace, under)).collect();
        let behind = |build: &Option<(usize, Timed)>, trace: &Option<(usize, Timed)>| {
            let least = [build, trace].into_iter().flatten().map(|timed| timed.0).min();
            least.filter(|&least| least < self.field.scenes.len())
        };
        let scenes: Vec<Vec<_>> =
            traces.iter().map(|trace| builds.iter().map(|build| behind(build, trace)).collect()).collect();
        let as_builds =
            |cost: &(usize, Timed)| builds.iter().flatten().next().is_none_or(|build| build.0 == cost.0);
        let cost = timed(Figure::Cost, &Under::Own).filter(as_builds).map(|timed| timed.1);
        let figures =
            |all: Vec<Option<(usize, Timed)>>| all.into_iter().map(|timed| Some(timed?.1)).collect();
        Some(Entry {
            cost,
            builds: figures(builds),
            traces: figures(traces),
            speeds: vec![None; self.unders.len()],
            rays: None,
            peak: None,
            scenes,
            error: None,
        })
    }

    fn scene(&self, scene: &SceneFigures<'_>) -> PlaceData {
        let entries: Vec<Option<Entry>> =
            self.field.trees.iter().map(|&tree| self.of_scene(scene, tree)).collect();
        let triangles = Some(scene.triangles());
        PlaceData { name: scene.scene().into(), triangles, scenes: 1, fronts: self.fronts(&entries), entries }
    }

    fn of_scene(&self, scene: &SceneFigures<'_>, tree: Tree<'_>) -> Option<Entry> {
        let rows = || scene.totals().iter().filter(|row| (row.builder.as_str(), row.width) == tree);
        rows().next()?;
        let timed = |figure, under: &Under| {
            let value = scene.figure(tree, figure, under).value()?.median;
            let ratio = scene.ratio_to(self.field.base, tree, figure, under);
            let interval =
                ratio.as_ref().map(SceneRatio::interval).filter(|interval| interval.high.is_finite());
            let [low, high] = [interval.map(|x| x.low), interval.map(|x| x.high)];
            Some([Some(value), ratio.map(|x| rounded(x.value)), low.map(rounded), high.map(rounded)])
        };
        let traced = |under: &Under| scene.trace(tree, under.kernel_of(tree.0)).value();
        let peak = match scene.build(tree) {
            Place::Value(row) => {
                row.peak_bytes.map(|bytes| rounded(bytes as f64 / row.triangles.max(1) as f64))
            }
            Place::Failed | Place::Missing => None,
        };
        Some(Entry {
            builds: self.regimes.iter().map(|&regime| timed(regime, &Under::Own)).collect(),
            cost: timed(Figure::Cost, &Under::Own),
            traces: self.unders.iter().map(|under| timed(Figure::Trace, under)).collect(),
            speeds: self.unders.iter().map(|under| traced(under)?.mrays_s).collect(),
            rays: self.unders.iter().find_map(|under| traced(under)?.rays),
            peak,
            scenes: Vec::new(),
            error: rows().find(|row| !row.error.is_empty()).map(|row| row.error.clone()),
        })
    }

    /// The fronts of a place, without trees of which it has a mean over fewer scenes, and without saved ones, which no
    /// builder built in that time.
    fn fronts(&self, entries: &[Option<Entry>]) -> Vec<Vec<[Vec<usize>; 3]>> {
        let at = |kernel: usize, regime: usize, tree: usize| {
            let entry = entries[tree].as_ref()?;
            let is_whole = entry.scenes.get(kernel).is_none_or(|scenes| scenes[regime].is_none());
            (is_whole && !is_saved(self.field.trees[tree].0)).then_some(())?;
            Some((entry.builds[regime]?[1]?, entry.traces[kernel]?[1]?))
        };
        let front_of = |kernel, regime, width: Option<u32>| {
            let is_in = |&tree: &usize| width.is_none_or(|width| self.field.trees[tree].1 == width);
            let points =
                (0..entries.len()).filter(is_in).filter_map(|tree| Some((tree, at(kernel, regime, tree)?)));
            let (trees, points): (Vec<usize>, Vec<(f64, f64)>) = points.unzip();
            front(&points).into_iter().map(|point| trees[point]).collect()
        };
        let of_regime =
            |kernel, regime| [None, Some(4), Some(8)].map(|width| front_of(kernel, regime, width));
        (0..self.unders.len())
            .map(|kernel| (0..self.regimes.len()).map(|regime| of_regime(kernel, regime)).collect())
            .collect()
    }

    fn curves(&self, under: &Under) -> Vec<Vec<Option<Vec<f64>>>> {
        let of_regime = |&regime: &Figure| {
            let totals = totals(self.field, regime, under);
            let curve = |tree: &Tree<'_>| {
                let of_tree = totals.iter().find(|totals| totals.tree == *tree)?;
                Some(budgets(CURVE).into_iter().map(|rays| rounded(of_tree.at(rays))).collect())
            };
            self.field.trees.iter().map(curve).collect()
        };
        self.regimes.iter().map(of_regime).collect()
    }
}

/// Five digits: more than any page shows.
fn rounded(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}
