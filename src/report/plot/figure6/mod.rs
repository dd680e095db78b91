//! Figure 6 of the paper from a run: build time against trace time, relative to Embree SAH, with the Pareto fronts.
//! Traces are whole frames, as in the paper, where the run has them, else the recorded rays.
//! [`averaged`] shows the trees of both widths, [`beside_paper`] the 4-wide ones beside the paper's points, and
//! [`by_scene`] every scene by itself.

mod points;

use super::chart::{Across, Front, INK, Panel, Point, Range, SMALL, sheet};
use super::key::{Entry, key, shapes};
use super::labels::Rect;
use super::pareto::front;
use super::svg::{Anchor, Svg};
use crate::bench::cell::is_saved;
use crate::bench::row::Row;
use crate::report::figures::{Figure, SceneFigures, Under, WIDTH, scenes, trees};
use crate::report::means::Ratios;
use crate::report::paper;
use points::{CUT, TreePoint, mean_points, papers, papers_of, scene_points, traced_by};

/// Panels side by side.
const ABREAST: usize = 3;

/// The averaged figure, arithmetic means as in the paper; `None` if the run has no point for it.
pub fn averaged(rows: &[Row], under: &Under) -> Option<String> {
    let ours = mean_points(rows, under, |_| true);
    let entries = Entry::of_widths(&widths(&ours));
    let fronts = fronts(&ours);
    one_panel(rows, under, ours, fronts, &entries)
}

/// The averaged figure of the 4-wide trees beside the paper's; `None` if the run has no point of a method of the paper.
pub fn beside_paper(rows: &[Row], under: &Under) -> Option<String> {
    let ours = mean_points(rows, under, |tree| tree.1 == WIDTH);
    if !ours.iter().any(|point| paper::builders().any(|builder| point.tree == (builder, WIDTH))) {
        return None;
    }
    let mean = |builder: &str, figure| Ratios::of_paper(builder, figure).arithmetic();
    let papers = papers(mean);
    let mut fronts = fronts(&ours);
    fronts.insert(0, front_through(&papers, Entry::Paper));
    let points = papers.into_iter().chain(ours).collect();
    one_panel(rows, under, points, fronts, &[Entry::Four, Entry::Paper])
}

/// A panel per scene, all with the same axes; `None` if the run has no point for any.
pub fn by_scene(rows: &[Row], under: &Under) -> Option<String> {
    let traced = traced_by(rows, under);
    let all: Vec<(String, Vec<TreePoint<'_>>)> = scenes(rows)
        .into_iter()
        .map(|name| {
            let points = scene_points(rows, &name, traced, under);
            (name, points)
        })
        .filter(|(_, points)| !points.is_empty())
        .collect();
    if all.is_empty() {
        return None;
    }
    let every = all.iter().flat_map(|(_, points)| points.iter().map(|point| &point.point));
    let of_paper: Vec<TreePoint<'_>> = all.iter().flat_map(|(name, _)| papers_of(name)).collect();
    let range = Range::of(every.chain(of_paper.iter().map(|paper| &paper.point)));
    let mut entries =
        Entry::of_widths(&all.iter().flat_map(|(_, points)| widths(points)).collect::<Vec<_>>());
    if all.iter().any(|(name, _)| paper::scene_of(name).is_some()) {
        entries.push(Entry::Paper);
    }
    let lines = all.len().div_ceil(ABREAST);
    let abreast = all.len().min(ABREAST);
    let (inside, pitch, left, top) = ((390.0, 280.0), (436.0, 342.0), 70.0, 150.0);
    let size = (left + abreast.max(2) as f64 * pitch.0, top + lines as f64 * pitch.1 + 16.0);
    let means = "each scene by itself; named are the trees on a front";
    let mut svg = with_key(size, rows, under, means, &entries);
    let count = all.len();
    for (index, (name, points)) in all.into_iter().enumerate() {
        let (column, line) = (index % ABREAST, index / ABREAST);
        let thousands = (SceneFigures::of(rows, &name).triangles() as f64 / 1000.0).round();
        let papers = papers_of(&name);
        let beside = paper::scene_of(&name).map_or_else(String::new, |scene| format!("; paper: {scene}"));
        let mut fronts = fronts(&points);
        // Axes are named once: at the left, and below the last panel of a column.
        let (across, up) = axes(traced);
        let axes = (
            if index + ABREAST >= count { across } else { String::new() },
            if column == 0 { up } else { String::new() },
        );
        let ours = named_on_fronts(points, &fronts);
        fronts.insert(0, front_through(&papers, Entry::Paper));
        let points = papers.into_iter().map(|paper| paper.point).chain(ours).collect();
        let title = format!("{name}, {thousands} k triangles{beside}");
        let panel = Panel { title, axes, range, across: Across::Logarithmic, fronts, points, font: 11.0 };
        let (x, y) = (left + column as f64 * pitch.0, top + line as f64 * pitch.1);
        panel.draw(&mut svg, Rect { x, y, width: inside.0, height: inside.1 });
    }
    Some(svg.finish())
}

/// The widths of some trees, ascending.
fn widths(points: &[TreePoint<'_>]) -> Vec<u32> {
    let mut widths: Vec<u32> = points.iter().map(|point| point.tree.1).collect();
    widths.sort_unstable();
    widths.dedup();
    widths
}

/// The front over all trees built, behind those of each width; a single width has one. Saved trees are on none.
fn fronts(points: &[TreePoint<'_>]) -> Vec<Front> {
    let is_built = |point: &&TreePoint<'_>| !is_saved(point.tree.0);
    let points: Vec<TreePoint<'_>> = points.iter().filter(is_built).cloned().collect();
    let widths = widths(&points);
    let of_width = |&width: &u32| {
        let of: Vec<TreePoint<'_>> = points.iter().filter(|point| point.tree.1 == width).cloned().collect();
        front_through(&of, Entry::of_width(width))
    };
    let over_all = (widths.len() > 1).then(|| front_through(&points, Entry::Both));
    over_all.into_iter().chain(widths.iter().map(of_width)).collect()
}

fn front_through(points: &[TreePoint<'_>], entry: Entry) -> Front {
    let at: Vec<(f64, f64)> = points.iter().map(|point| point.point.at).collect();
    Front { through: front(&at).into_iter().map(|i| at[i]).collect(), line: entry.line() }
}

/// Leaves the names of trees on a front: more do not fit a small panel.
fn named_on_fronts(points: Vec<TreePoint<'_>>, fronts: &[Front]) -> Vec<Point> {
    let mut points: Vec<Point> = points.into_iter().map(|point| point.point).collect();
    for point in &mut points {
        let is_named = fronts.iter().any(|front| front.through.contains(&point.at));
        point.label = point.label.take().filter(|_| is_named);
    }
    points
}

fn one_panel(
    rows: &[Row],
    under: &Under,
    points: Vec<TreePoint<'_>>,
    fronts: Vec<Front>,
    entries: &[Entry],
) -> Option<String> {
    if points.is_empty() {
        return None;
    }
    let is_cut = points.iter().any(|point| point.is_cut);
    let points: Vec<Point> = points.into_iter().map(|point| point.point).collect();
    let range = Range::of(&points);
    let panel = Panel {
        title: String::new(),
        axes: axes(traced_by(rows, under)),
        range,
        across: Across::Logarithmic,
        fronts,
        points,
        font: 13.0,
    };
    let count = scenes(rows).len();
    let noun = if count == 1 { "scene" } else { "scenes" };
    let has_intervals = panel.points.iter().any(|point| point.interval.is_some());
    let intervals = if has_intervals { " with their 95 % intervals" } else { "" };
    let mut svg = with_key(
        (820.0, 720.0),
        rows,
        under,
        &format!("arithmetic means of {count} {noun}{intervals}"),
        entries,
    );
    panel.draw(&mut svg, Rect { x: 78.0, y: 134.0, width: 716.0, height: 516.0 });
    if is_cut {
        let note = format!("intervals that reach zero are drawn from {CUT} of their mean");
        svg.text((20.0, 711.0), Anchor::Start, SMALL, INK, &note, "");
    }
    Some(svg.finish())
}

fn axes(traced: Figure) -> (String, String) {
    ("build time / Embree SAH, 4-wide".into(), format!("{} time / Embree SAH, 4-wide", name_of(traced)))
}

/// The figure upwards in words.
fn name_of(traced: Figure) -> &'static str {
    if traced == Figure::Frame { "frame" } else { "trace" }
}

/// A sheet with title, what was measured and how, and the key.
fn with_key(size: (f64, f64), rows: &[Row], under: &Under, means: &str, entries: &[Entry]) -> Svg {
    let traced = traced_by(rows, under);
    let title = format!("Build time against {} time, relative to Embree SAH at width 4", name_of(traced));
    let threads = rows.first().map_or(0, |row| row.threads);
    let about = format!("{means}, {threads} threads, both axes logarithmic");
    let traces = if traced == Figure::Frame { "whole path-traced frames" } else { "traces" };
    let mut svg = sheet(size, &title, &[&about, &format!("{traces}: {}", under.about())]);
    entries.iter().fold(26.0, |x, &entry| key(&mut svg, (x, 88.5), entry, SMALL) + 26.0);
    let builders: Vec<&str> = trees(rows).into_iter().map(|tree| tree.0).collect();
    shapes(&mut svg, (26.0, 108.5), &builders, SMALL);
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_frames_are_shown_where_all_traces_have_them() {
        let row = |builder: &str, trace: f64, frame: f64| Row {
            frame_ms_median: Some(frame),
            frame_ms_mad: Some(0.0),
            frame_ms_min: Some(frame),
            frame_ms_max: Some(frame),
            ..Row::by_hand(builder, 4, "phr", 10.0, trace)
        };
        let mut rows = vec![row("embree-sah", 10.0, 10.0), row("lbvh", 20.0, 15.0)];
        let under = Under::One("phr".into());
        let height = |rows: &[Row]| {
            let points = [
                mean_points(rows, &under, |_| true),
                scene_points(rows, &rows[0].scene, traced_by(rows, &under), &under),
            ];
            points.map(|points| points.iter().find(|point| point.tree.0 == "lbvh").unwrap().point.at.1)
        };
        assert_eq!(height(&rows), [1.5; 2]);
        for svg in [averaged(&rows, &under), beside_paper(&rows, &under), by_scene(&rows, &under)] {
            assert!(svg.unwrap().contains(">frame time / Embree SAH, 4-wide<"));
        }
        rows[1].frame_ms_median = None;
        assert_eq!(height(&rows), [2.0; 2]);
        assert!(averaged(&rows, &under).unwrap().contains(">trace time / Embree SAH, 4-wide<"));
    }

    #[test]
    fn no_figure_falls_off_logarithmic_axes() {
        let row = |scene: &str, builder: &str, build: f64| Row {
            scene: scene.into(),
            ..Row::by_hand(builder, 4, "phr", build, 1.0)
        };
        // The interval of 0.05 and 3 reaches below zero, and a time of zero has no logarithm.
        let sah = ["a", "b"].map(|scene| row(scene, "embree-sah", 10.0));
        let others = [row("a", "lbvh", 0.5), row("b", "lbvh", 30.0), row("a", "aac", 0.0)];
        let rows = [&sah[..], &others].concat();
        let under = Under::One("phr".into());
        assert!(mean_points(&rows, &under, |_| true).iter().any(|point| point.point.interval.is_some()));
        let tells_of_cuts =
            |rows: &[Row]| averaged(rows, &under).is_some_and(|svg| svg.contains("from 0.2 of their mean"));
        assert!(tells_of_cuts(&rows));
        let alike = [&sah[..], &[row("a", "lbvh", 5.0), row("b", "lbvh", 5.1)]].concat();
        assert!(averaged(&alike, &under).unwrap().contains("with their 95 % intervals"));
        assert!(!tells_of_cuts(&alike));
        for svg in [averaged(&rows, &under), by_scene(&rows, &under)] {
            let svg = svg.unwrap();
            assert!(svg.contains(">lbvh") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }
}
