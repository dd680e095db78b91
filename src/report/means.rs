//! Means over scenes of the figures relative to Embree SAH, beside the paper's: arithmetic as in its
//! Figure 6, and geometric, which is the right one for ratios. The worst scene is named.

use super::figures::interval::{self, Interval, Noise, Over, SceneRatio};
use super::figures::{BASELINE, Figure, NATIVE, OWN, SceneFigures, Tree, Under, kernels, tree_name, trees};
use super::grid::Grid;
use super::paper;
use crate::bench::row::Row;
use crate::bench::statistics::{arithmetic_mean, geometric_mean};

/// Ratios of one tree with their scenes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ratios(pub Vec<SceneRatio>);

impl Ratios {
    /// The ratios of a run to Embree SAH, see [`Ratios::to`].
    pub fn of(rows: &[Row], tree: Tree<'_>, figure: Figure, under: &Under) -> Self {
        Self::to(BASELINE, rows, tree, figure, under)
    }

    /// The ratios of a run to `base`, without scenes that lack the figure of either tree.
    pub fn to(base: Tree<'_>, rows: &[Row], tree: Tree<'_>, figure: Figure, under: &Under) -> Self {
        Self::among(&SceneFigures::all(rows), base, tree, figure, under)
    }

    /// The ratios to `base` in `of_scenes`, without scenes that lack the figure of either tree.
    pub fn among(
        of_scenes: &[SceneFigures<'_>],
        base: Tree<'_>,
        tree: Tree<'_>,
        figure: Figure,
        under: &Under,
    ) -> Self {
        Self(of_scenes.iter().filter_map(|scene| scene.ratio_to(base, tree, figure, under)).collect())
    }

    /// The ratios in the paper.
    pub fn of_paper(builder: &str, figure: Figure) -> Self {
        let ratio = |(scene, value)| SceneRatio { scene, value, noise: Noise::Error(f64::INFINITY) };
        Self(paper::ratios(builder, figure).into_iter().map(ratio).collect())
    }

    fn values(&self) -> Vec<f64> {
        self.0.iter().map(|ratio| ratio.value).collect()
    }

    /// As in the paper's Figure 6.
    pub fn arithmetic(&self) -> Option<f64> {
        arithmetic_mean(&self.values())
    }

    /// The mean for ratios.
    pub fn geometric(&self) -> Option<f64> {
        geometric_mean(&self.values())
    }

    /// What an interval is over: scenes and rounds, or rounds alone where there is one scene.
    pub fn over(&self) -> Over {
        if self.0.len() > 1 { Over::ScenesAndRounds } else { Over::Rounds }
    }

    /// The interval of the geometric mean.
    pub fn interval(&self, over: Over) -> Option<Interval> {
        interval::of_mean(&self.0, over)
    }

    /// The interval of the arithmetic mean over scenes and rounds; `None` where nothing is known.
    pub fn arithmetic_interval(&self) -> Option<Interval> {
        interval::of_arithmetic_mean(&self.0).filter(|interval| interval.high.is_finite())
    }

    /// The geometric mean with its interval over scenes and rounds, as `0.87 [0.84, 0.90]`.
    pub fn shown(&self) -> Option<String> {
        let interval = self.interval(Over::ScenesAndRounds)?;
        Some(format!("{:.2} {}", self.geometric()?, interval.shown(2)))
    }

    /// Half the interval of the geometric mean over rounds alone, as `±1.3 %`; empty for figures without noise.
    pub fn noise(&self) -> String {
        let half =
            self.interval(Over::Rounds).zip(self.geometric()).map(|(rounds, mean)| rounds.half_width(mean));
        match half {
            Some(0.0) => String::new(),
            Some(half) if half.is_finite() => format!("±{:.1} %", 100.0 * half),
            _ => "±?".into(),
        }
    }

    /// The greatest as [`beside_mean`] shows it.
    pub fn worst_shown(&self) -> Option<[String; 2]> {
        Some(beside_mean(self.worst()?, self.0.len(), self.geometric()?, 2))
    }

    /// The least.
    pub fn least(&self) -> Option<&SceneRatio> {
        self.0.iter().reduce(|least, other| if other.value < least.value { other } else { least })
    }

    /// The greatest.
    pub fn worst(&self) -> Option<&SceneRatio> {
        self.0.iter().reduce(|worst, other| if other.value > worst.value { other } else { worst })
    }
}

/// A scene's ratio among those of `scenes` scenes, whose mean is `mean`, in two cells: the ratio with its own
/// interval over rounds, where it has noise, and the scene, with a remark where that interval reaches the mean of
/// several.
pub fn beside_mean(ratio: &SceneRatio, scenes: usize, mean: f64, digits: usize) -> [String; 2] {
    let (value, interval) = (format!("{:.digits$}", ratio.value), ratio.interval());
    if ratio.noise == Noise::NONE {
        return [value, ratio.scene.clone()];
    }
    // A last bit tells nothing apart.
    let (low, high) = (interval.low * (1.0 - 1e-9), interval.high * (1.0 + 1e-9));
    let told = if scenes > 1 && low <= mean && mean <= high { NOT_TOLD_APART } else { "" };
    [format!("{value} {}", interval.shown(digits)), format!("{}{told}", ratio.scene)]
}

const NOT_TOLD_APART: &str = ", not told apart";
/// What [`beside_mean`] shows.
pub const WORST: &str = "worst: the largest ratio of a scene, with its own 95 % interval over rounds; not told apart: that interval includes the mean.";

/// The tables of means: build time, cost, frame and trace time; nothing without Embree SAH.
pub fn means(rows: &[Row], under: &Under) -> String {
    let sections = [
        ("Build time", Figure::Build),
        ("Build time, first of a new builder or device", Figure::First),
        ("Build time, all memory reused", Figure::Rebuild),
        ("Build time on processors, all threads, intervals over scenes alone", Figure::BuildCpu),
        ("Instructions of builds, all threads, intervals over scenes alone", Figure::BuildInstructions),
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
        "## Means relative to Embree SAH at width 4\n\n{text}{}\
         arith.: arithmetic mean, as in the paper's Figure 6. geo.: geometric mean. 95 %: its interval over scenes and \
         rounds, what it would be over other scenes of the kind. noise: half its interval over rounds alone, what \
         another measurement of these scenes would change (±?: of too few rounds, or too far apart). {WORST} paper: the same mean over \
         the paper's nine scenes, 16 threads, Embree 2.11; its trace time is that of frames.\n",
        by_kernel(rows),
    )
}

fn show(value: Option<f64>) -> String {
    value.map_or_else(|| "-".into(), |value| format!("{value:.3}"))
}

fn table(rows: &[Row], figure: Figure, under: &Under) -> Grid {
    let mut grid =
        Grid::new(["method", "arith.", "paper", "geo.", "95 %", "noise", "paper", "worst", "in", "scenes"]);
    for tree in trees(rows) {
        let ratios = Ratios::of(rows, tree, figure, under);
        let Some([worst_value, worst_scene]) = ratios.worst_shown() else { continue };
        let is_base = tree == BASELINE;
        let interval = ratios.interval(Over::ScenesAndRounds).filter(|_| !is_base);
        // The paper's trees are all four wide.
        let paper =
            if tree_name(tree) == tree.0 { Ratios::of_paper(tree.0, figure) } else { Ratios::default() };
        grid.push(vec![
            tree_name(tree),
            show(ratios.arithmetic()),
            show(paper.arithmetic()),
            show(ratios.geometric()),
            interval.map_or_else(String::new, |interval| interval.shown(3)),
            if is_base { String::new() } else { ratios.noise() },
            show(paper.geometric()),
            worst_value,
            worst_scene,
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
