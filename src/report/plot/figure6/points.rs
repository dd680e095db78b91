//! The points of Figure 6: trees of a run at their means or in a scene, and the paper's.

use super::super::chart::Point;
use super::super::families::style;
use super::super::key::Entry;
use crate::bench::row::Row;
use crate::report::figures::{BASELINE, Figure, SceneFigures, Tree, Under, WIDTH, scenes, tree_name, trees};
use crate::report::means::Ratios;
use crate::report::paper;

/// From where an interval that reaches zero is drawn, as a share of its mean: logarithmic axes have no zero.
pub const CUT: f64 = 0.2;

/// A point of a figure with the tree that it stands for.
#[derive(Clone)]
pub struct TreePoint<'a> {
    /// The tree.
    pub tree: Tree<'a>,
    /// Its point.
    pub point: Point,
    /// An end of its interval is at [`CUT`], not where it was measured.
    pub is_cut: bool,
}

impl<'a> TreePoint<'a> {
    /// Filled at width 4, hollow at width 8.
    fn new(tree: Tree<'a>, at: (f64, f64), label: String) -> Self {
        let (shape, colour) = style(tree.0);
        let is_hollow = tree.1 != WIDTH;
        let point = Point { at, shape, colour, is_hollow, label: Some(label), interval: None };
        Self { tree, point, is_cut: false }
    }
}

/// The trees that `keep` accepts, at their arithmetic means over scenes.
pub fn mean_points<'a>(
    rows: &'a [Row],
    under: &Under,
    keep: impl Fn(Tree<'_>) -> bool,
) -> Vec<TreePoint<'a>> {
    let (count, trace_figure) = (scenes(rows).len(), traced_by(rows, under));
    let point = |tree| {
        let ratios = |figure| Ratios::of(rows, tree, figure, under);
        let (build, trace) = (ratios(Figure::Build), ratios(trace_figure));
        let at = placed((build.arithmetic()?, trace.arithmetic()?))?;
        // A mean over fewer scenes is another mean.
        let traced = trace.0.len().min(build.0.len());
        let of = if traced < count { format!(" ({traced} of {count})") } else { String::new() };
        let mut point = TreePoint::new(tree, at, tree_name(tree) + &of);
        let intervals = build.arithmetic_interval().zip(trace.arithmetic_interval());
        if let Some((across, up)) = intervals.filter(|_| tree != BASELINE) {
            // That of few scenes unlike each other may reach below zero.
            let low = |low: f64, mean: f64| if low > 0.0 { low } else { CUT * mean };
            point.is_cut = across.low <= 0.0 || up.low <= 0.0;
            point.point.interval = Some([(low(across.low, at.0), across.high), (low(up.low, at.1), up.high)]);
        }
        Some(point)
    };
    trees(rows).into_iter().filter(|&tree| keep(tree)).filter_map(point).collect()
}

/// The trees of a scene, with the figure upwards of the run, see [`traced_by`].
pub fn scene_points<'a>(
    rows: &'a [Row],
    scene: &str,
    trace_figure: Figure,
    under: &Under,
) -> Vec<TreePoint<'a>> {
    let figures = SceneFigures::of(rows, scene);
    let point = |tree| {
        let ratio = |figure| Some(figures.ratio(tree, figure, under)?.value);
        let at = placed((ratio(Figure::Build)?, ratio(trace_figure)?))?;
        Some(TreePoint::new(tree, at, tree_name(tree)))
    };
    trees(rows).into_iter().filter_map(point).collect()
}

/// The same, if it has a place on logarithmic axes: a row may have a time of zero.
fn placed(at: (f64, f64)) -> Option<(f64, f64)> {
    [at.0, at.1].iter().all(|ratio| *ratio > 0.0 && ratio.is_finite()).then_some(at)
}

/// The paper's methods, at the means that `mean` tells.
pub fn papers(mean: impl Fn(&str, Figure) -> Option<f64>) -> Vec<TreePoint<'static>> {
    let point = |builder: &'static str| {
        let at = (mean(builder, Figure::Build)?, mean(builder, Figure::Frame)?);
        let mut paper = TreePoint::new((builder, WIDTH), at, builder.to_owned());
        paper.point.is_hollow = true;
        paper.point.colour = Entry::Paper.colour();
        // Embree SAH is at 1 in either.
        paper.point.label = paper.point.label.filter(|_| builder != BASELINE.0);
        Some(paper)
    };
    paper::builders().filter_map(point).collect()
}

/// The paper's methods in the scene of ours, if the paper has it, without names.
pub fn papers_of(scene: &str) -> Vec<TreePoint<'static>> {
    let in_paper = paper::scene_of(scene);
    let ratio = |builder: &str, figure| {
        let ratios = paper::ratios(builder, figure);
        ratios.into_iter().find(|(scene, _)| Some(scene) == in_paper.as_ref()).map(|(_, ratio)| ratio)
    };
    let mut points = papers(ratio);
    points.iter_mut().for_each(|paper| paper.point.label = None);
    points
}

/// The figure upwards, one for all of a run: whole frames and the recorded rays are not mixed.
pub fn traced_by(rows: &[Row], under: &Under) -> Figure {
    SceneFigures::traced_by(&SceneFigures::all(rows), under)
}
