//! Figure 6 of the paper from a run: build time against trace time, relative to Embree SAH, with the Pareto
//! front; averaged over the scenes, and a panel per scene. The paper's points stand beside ours.

use super::chart::{DASHES, Front, GREY, INK, Panel, Point, Range, SMALL, sheet, style};
use super::labels::Rect;
use super::pareto::front;
use super::raster::text_width;
use super::svg::{Anchor, Svg};
use crate::bench::row::Row;
use crate::report::figures::{BASELINE, Figure, SceneFigures, Under, WIDTH, scenes, trees};
use crate::report::means::Ratios;
use crate::report::paper;

/// Panels side by side.
const ABREAST: usize = 3;
const OUR_FRONT: &str = "#4d4d4d";
const PAPER_FRONT: &str = "#c4c4c4";

fn our_point(builder: &str, at: (f64, f64), label: String) -> Point {
    let (shape, colour) = style(builder);
    Point { at, shape, colour, is_hollow: false, label: Some(label) }
}

fn front_of(points: &[Point], is_of_paper: bool) -> Front {
    let at: Vec<(f64, f64)> = points.iter().map(|point| point.at).collect();
    let colour = if is_of_paper { PAPER_FRONT } else { OUR_FRONT };
    Front { through: front(&at).into_iter().map(|i| at[i]).collect(), colour, is_dashed: is_of_paper }
}

/// The paper's points, at the means or figures that `ratio` tells.
fn papers(ratio: impl Fn(&str, Figure) -> Option<f64>, are_labelled: bool) -> Vec<Point> {
    let point = |builder| {
        let at = (ratio(builder, Figure::Build)?, ratio(builder, Figure::Trace)?);
        // Embree SAH is at 1 in either.
        let label = (are_labelled && builder != BASELINE.0).then(|| builder.to_owned());
        Some(Point { at, shape: style(builder).0, colour: GREY, is_hollow: true, label })
    };
    paper::builders().filter_map(point).collect()
}

/// The paper's points behind ours.
fn panel(title: String, ours: Vec<Point>, papers: Vec<Point>, font: f64) -> Panel {
    let fronts = vec![front_of(&papers, true), front_of(&ours, false)];
    let points: Vec<Point> = papers.into_iter().chain(ours).collect();
    Panel { title, axes: (String::new(), String::new()), range: Range::of(&points), fronts, points, font }
}

fn axes() -> (String, String) {
    ("build time / Embree SAH".into(), "trace time / Embree SAH".into())
}

/// Builders of the paper's width in the run.
fn builders(rows: &[Row]) -> Vec<&str> {
    trees(rows).into_iter().filter(|tree| tree.1 == WIDTH).map(|tree| tree.0).collect()
}

/// The averaged figure, arithmetic means as in the paper; `None` if the run has no point for it.
pub fn averaged(rows: &[Row], under: &Under) -> Option<String> {
    let count = scenes(rows).len();
    let mut ours = Vec::new();
    for builder in builders(rows) {
        let ratios = |figure| Ratios::of(rows, (builder, WIDTH), figure, under);
        let (build, trace) = (ratios(Figure::Build), ratios(Figure::Trace));
        let (Some(x), Some(y)) = (build.arithmetic(), trace.arithmetic()) else { continue };
        // A mean over fewer scenes is another mean.
        let traced = trace.0.len().min(build.0.len());
        let label =
            if traced < count { format!("{builder} ({traced} of {count})") } else { builder.to_owned() };
        ours.push(our_point(builder, (x, y), label));
    }
    if ours.is_empty() {
        return None;
    }
    let mean = |builder: &str, figure| Ratios::of_paper(builder, figure).arithmetic();
    let papers = papers(mean, true);
    let panel = Panel { axes: axes(), ..panel(String::new(), ours, papers, 13.0) };
    let noun = if count == 1 { "scene" } else { "scenes" };
    let means = format!("arithmetic means of {count} {noun}");
    let mut svg = with_key((820.0, 660.0), rows, under, &means, true);
    panel.draw(&mut svg, Rect { x: 78.0, y: 114.0, width: 716.0, height: 476.0 });
    Some(svg.finish())
}

/// A panel per scene, all with the same axes; `None` if the run has no point for any.
pub fn by_scene(rows: &[Row], under: &Under) -> Option<String> {
    let mut panels: Vec<Panel> = scenes(rows).iter().filter_map(|name| of_scene(rows, name, under)).collect();
    let range = Range::of(panels.iter().flat_map(|panel| &panel.points));
    let lines = panels.len().div_ceil(ABREAST);
    if lines == 0 {
        return None;
    }
    let abreast = panels.len().min(ABREAST);
    let (inside, pitch, left, top) = ((330.0, 250.0), (372.0, 312.0), 70.0, 130.0);
    let size = (left + abreast.max(2) as f64 * pitch.0, top + lines as f64 * pitch.1 + 16.0);
    let has_papers = panels.iter().any(|panel| panel.points.iter().any(|point| point.is_hollow));
    let mut svg = with_key(size, rows, under, "each scene by itself", has_papers);
    let count = panels.len();
    for (index, panel) in panels.iter_mut().enumerate() {
        let (column, line) = (index % ABREAST, index / ABREAST);
        panel.range = range;
        // Axes are named once: at the left, and below the last panel of a column.
        let (across, up) = axes();
        panel.axes.0 = if index + ABREAST >= count { across } else { String::new() };
        panel.axes.1 = if column == 0 { up } else { String::new() };
        let (x, y) = (left + column as f64 * pitch.0, top + line as f64 * pitch.1);
        panel.draw(&mut svg, Rect { x, y, width: inside.0, height: inside.1 });
    }
    Some(svg.finish())
}

fn of_scene(rows: &[Row], name: &str, under: &Under) -> Option<Panel> {
    let figures = SceneFigures::of(rows, name);
    let ours: Vec<Point> = builders(rows)
        .into_iter()
        .filter_map(|builder| {
            let ratio = |figure| Some(figures.ratio((builder, WIDTH), figure, under)?.value);
            let at = (ratio(Figure::Build)?, ratio(Figure::Trace)?);
            Some(our_point(builder, at, builder.to_owned()))
        })
        .collect();
    if ours.is_empty() {
        return None;
    }
    let paper_scene = paper::scene_of(name);
    let ratio = |builder: &str, figure| {
        let ratios = paper::ratios(builder, figure);
        ratios.into_iter().find(|(scene, _)| Some(scene) == paper_scene.as_ref()).map(|(_, ratio)| ratio)
    };
    let papers = papers(ratio, false);
    let thousands = (figures.triangles() as f64 / 1000.0).round();
    let beside = paper_scene.map_or_else(String::new, |scene| format!("; paper: {scene}"));
    Some(panel(format!("{name}, {thousands} k triangles{beside}"), ours, papers, 11.0))
}

/// A sheet with title, what was measured and how, and the key; `has_papers` if it shows points of the paper.
fn with_key(size: (f64, f64), rows: &[Row], under: &Under, means: &str, has_papers: bool) -> Svg {
    let title = "Build time against trace time, relative to Embree SAH at width 4";
    let threads = rows.first().map_or(0, |row| row.threads);
    let about = format!("{means}, {threads} threads, both axes logarithmic");
    let mut svg = sheet(size, title, &[&about, &format!("traces: {}", under.about())]);
    let end = key(&mut svg, 26.0, false, "this run and its front");
    if has_papers {
        key(&mut svg, end + 30.0, true, "the paper (16 threads, Embree 2.11, frame times) and its front");
    }
    svg
}

/// A line of the key from `x` on; returns where it ends.
fn key(svg: &mut Svg, x: f64, is_of_paper: bool, text: &str) -> f64 {
    let y = 88.5;
    for (i, builder) in ["embree", "phr", "hunt", "aac"].into_iter().enumerate() {
        let (shape, colour) = style(builder);
        let colour = if is_of_paper { GREY } else { colour };
        svg.point((x + 15.0 * i as f64, y), shape, 4.7, colour, is_of_paper);
    }
    let (colour, dashes) = if is_of_paper { (PAPER_FRONT, DASHES) } else { (OUR_FRONT, "") };
    svg.line(&[(x + 60.0, y), (x + 84.0, y)], colour, 1.5, dashes);
    svg.text((x + 90.0, y + 4.5), Anchor::Start, SMALL, INK, text, "");
    x + 90.0 + text_width(text, SMALL)
}
