//! Draws a split in two dimensions: the boxes of the cut, projected along the axis in which they tell least.

use super::choose::axes;
use super::{Kind, Picture};
use crate::builders::steps::split_boxes::SplitBoxes;
use crate::geometry::Aabb;
use crate::report::plot::chart::{GREY, INK, SMALL, sheet};
use crate::report::plot::labels::Rect;
use crate::report::plot::raster::text_width;
use crate::report::plot::svg::{Anchor, Svg};

/// Colours of the two sides, after Okabe and Ito.
const SIDES: [&str; 2] = ["#0072b2", "#d55e00"];
/// Of nodes of the cut that are on both, which bear an asterisk.
const BOTH: &str = "#4d4d4d";
/// Of the other side's nodes.
const FAINT: &str = "#d9d9d9";
const COLUMN: f64 = 400.0;
const GAP: f64 = 44.0;
const TOP: f64 = 118.0;
const LEFT: f64 = 26.0;
const DASHED: &str = " stroke-dasharray=\"6 3\"";
const DOTTED: &str = " stroke-dasharray=\"2 2\"";

/// A projection of boxes to a place on the sheet.
struct Projection {
    axes: [usize; 2],
    from: [f64; 2],
    scale: f64,
    place: Rect,
}

/// The picture: the split found, the cut partitioned, both sides refined.
pub fn draw(picture: &Picture) -> String {
    let split = &picture.split;
    let bounds = split.bounds();
    let (extent, [across, up]) = (bounds.extent(), axes(split));
    let ratio = f64::from(extent[up]) / f64::from(extent[across]).max(1e-30);
    let height = (COLUMN * ratio).clamp(120.0, 440.0);
    let size = (LEFT + 3.0 * (COLUMN + GAP) - 10.0, TOP + 2.0 * height + 84.0);
    let thousands = (picture.triangles as f64 / 1000.0).round();
    let title = format!("{} of {} in {}", picture.kind, picture.builder, picture.scene);
    let name = |axis: usize| ["x", "y", "z"][axis];
    let about = format!(
        "{thousands} k triangles; a cut of {} nodes below {} binary splits; {} across, {} up, seen along {}; pale grey: the \
         other side",
        split.cut.len(),
        split.depth,
        name(across),
        name(up),
        name(3 - across - up)
    );
    let mut svg = sheet(size, &title, &[&about]);
    key(&mut svg, picture.kind);
    let at = |column: f64, top: f64| {
        let place = Rect { x: LEFT + column * (COLUMN + GAP), y: top, width: COLUMN, height };
        Projection::new(bounds, [across, up], place)
    };
    let lower = TOP + height + 60.0;

    let whole = at(0.0, TOP + 0.5 * (height + 60.0));
    whole.heading(&mut svg, &format!("1. find the split of the {} nodes", split.cut.len()));
    for node in &split.cut {
        match membership(split, node) {
            [true, true] => whole.node_on_both(&mut svg, node, BOTH),
            [true, false] => whole.node(&mut svg, node, SIDES[0], PALE),
            _ => whole.node(&mut svg, node, SIDES[1], PALE),
        }
    }
    whole.plane(&mut svg, split.plane);

    for (number, top) in [(0, TOP), (1, lower)] {
        let (side, other, colour) = (&split.sides[number], &split.sides[1 - number], SIDES[number]);
        let is_on_both = |node: &Aabb| split.plane.is_some() && !split.cut.contains(node);
        let parted = at(1.0, top);
        let clipped = if split.plane.is_some() { ", clipped" } else { "" };
        let word = ["left", "right"][number];
        parted.heading(&mut svg, &format!("2. {word}: {} nodes{clipped}", side.nodes().count()));
        other.nodes().for_each(|node| parted.outline(&mut svg, node, FAINT, ""));
        parted.clip(&mut svg, &side.clip, split.plane);
        for node in side.nodes() {
            if is_on_both(node) {
                parted.node_on_both(&mut svg, node, colour);
            } else {
                parted.node(&mut svg, node, colour, PALE);
            }
        }
        parted.plane(&mut svg, split.plane);

        let finer = at(2.0, top);
        let discarded: Vec<&Aabb> = side.opened.iter().flat_map(|node| &node.discarded).collect();
        let less = match discarded.len() {
            0 => String::new(),
            1 => ", 1 child discarded".into(),
            more => format!(", {more} children discarded"),
        };
        let (refined, opened) = (side.refined().count(), side.opened.len());
        finer.heading(&mut svg, &format!("3. refined: {refined} nodes, {opened} opened{less}"));
        other.refined().for_each(|node| finer.outline(&mut svg, node, FAINT, ""));
        finer.clip(&mut svg, &side.clip, split.plane);
        discarded.into_iter().for_each(|child| finer.discarded(&mut svg, child));
        for node in &side.kept {
            if is_on_both(node) {
                finer.node_on_both(&mut svg, node, colour);
            } else {
                finer.node(&mut svg, node, colour, PALE);
            }
        }
        for child in side.opened.iter().flat_map(|node| &node.children) {
            finer.node(&mut svg, child, colour, STRONG);
        }
        for node in &side.opened {
            finer.outline(&mut svg, &node.bounds, INK, DASHED);
            if is_on_both(&node.bounds) {
                finer.asterisk(&mut svg, &node.bounds);
            }
        }
        finer.plane(&mut svg, split.plane);
    }
    svg.finish()
}

/// On which sides a node of the cut is.
fn membership(split: &SplitBoxes, node: &Aabb) -> [bool; 2] {
    match split.plane {
        Some(plane) => {
            let (min, max) = (node.min[split.axis], node.max[split.axis]);
            [min < plane || max <= plane, max > plane]
        }
        None => split.sides.each_ref().map(|side| side.nodes().any(|other| other == node)),
    }
}

/// How much a node's colour covers: one that was there, and a child of one that was opened.
const PALE: &str = "0.14";
const STRONG: &str = "0.5";

fn key(svg: &mut Svg, kind: Kind) {
    let (mut x, y, size) = (LEFT, 66.0, (20.0, 13.0));
    let boxed = |x: f64| [(x, y), (x + size.0, y), (x + size.0, y + size.1), (x, y + size.1), (x, y)];
    let mut text = |svg: &mut Svg, text: &str| {
        svg.text((x + 27.0, y + 11.0), Anchor::Start, SMALL, INK, text, "");
        x += 52.0 + text_width(text, SMALL);
        x
    };
    let filled = |svg: &mut Svg, x: f64, colour: &str, opacity: &str| {
        let more = format!(" fill-opacity=\"{opacity}\" stroke=\"{colour}\" stroke-width=\"1.3\"");
        svg.fill((x, y), size, colour, &more);
    };
    filled(svg, LEFT, SIDES[0], PALE);
    let at = text(svg, "left");
    filled(svg, at, SIDES[1], PALE);
    let at = text(svg, "right");
    svg.line(&boxed(at), INK, 1.2, DASHED);
    let at = text(svg, "opened");
    filled(svg, at, SIDES[0], STRONG);
    let at = text(svg, "its child");
    if kind == Kind::Spatial {
        svg.fill((at, y), size, GREY, CROSSED);
        cross(svg, [at, y, at + size.0, y + size.1]);
        let at = text(svg, "discarded child");
        svg.text((at + 10.0, y + 15.0), Anchor::Middle, 20.0, INK, "*", " font-weight=\"bold\"");
        let at = text(svg, "on both sides");
        svg.line(&[(at + 10.0, y - 2.0), (at + 10.0, y + 15.0)], INK, 2.4, "");
        let at = text(svg, "plane");
        svg.line(&boxed(at), INK, 1.0, DOTTED);
        text(svg, "clip box");
    }
}

/// The fill of what is crossed out.
const CROSSED: &str = " fill-opacity=\"0.2\" stroke=\"#6b6b6b\" stroke-width=\"1\"";

fn cross(svg: &mut Svg, [left, top, right, bottom]: [f64; 4]) {
    svg.line(&[(left, top), (right, bottom)], "#6b6b6b", 1.0, "");
    svg.line(&[(left, bottom), (right, top)], "#6b6b6b", 1.0, "");
}

impl Projection {
    /// The box `bounds` as large as it fits into `place`, in the middle, in its own proportions.
    fn new(bounds: Aabb, axes: [usize; 2], place: Rect) -> Self {
        let extent = axes.map(|axis| f64::from(bounds.extent()[axis]).max(1e-30));
        let scale = (place.width / extent[0]).min(place.height / extent[1]);
        let margin = [0.5 * (place.width - scale * extent[0]), 0.5 * (place.height - scale * extent[1])];
        let from = [0, 1].map(|i| f64::from(bounds.min[axes[i]]) - margin[i] / scale);
        Self { axes, from, scale, place }
    }

    fn x(&self, value: f32) -> f64 {
        let x = self.place.x + self.scale * (f64::from(value) - self.from[0]);
        // Not by `clamp`, which panics where a place is no number.
        x.max(self.place.x).min(self.place.x + self.place.width)
    }

    fn y(&self, value: f32) -> f64 {
        let y = self.place.y + self.place.height - self.scale * (f64::from(value) - self.from[1]);
        y.max(self.place.y).min(self.place.y + self.place.height)
    }

    /// Left, top, right and bottom of a box.
    fn corners(&self, bounds: &Aabb) -> [f64; 4] {
        let [across, up] = self.axes;
        [
            self.x(bounds.min[across]),
            self.y(bounds.max[up]),
            self.x(bounds.max[across]),
            self.y(bounds.min[up]),
        ]
    }

    fn node(&self, svg: &mut Svg, bounds: &Aabb, colour: &str, opacity: &str) {
        let [left, top, right, bottom] = self.corners(bounds);
        let more = format!(" fill-opacity=\"{opacity}\" stroke=\"{colour}\" stroke-width=\"1.3\"");
        svg.fill((left, top), (right - left, bottom - top), colour, &more);
    }

    fn node_on_both(&self, svg: &mut Svg, bounds: &Aabb, colour: &str) {
        self.node(svg, bounds, colour, PALE);
        self.asterisk(svg, bounds);
    }

    fn asterisk(&self, svg: &mut Svg, bounds: &Aabb) {
        let [left, top, right, bottom] = self.corners(bounds);
        let at = (0.5 * (left + right), 0.5 * (top + bottom) + 10.0);
        svg.text(at, Anchor::Middle, 22.0, INK, "*", " font-weight=\"bold\"");
    }

    /// A box that is not there any more, as far as it is within the picture.
    fn discarded(&self, svg: &mut Svg, bounds: &Aabb) {
        let [left, top, right, bottom] = self.corners(bounds);
        svg.fill((left, top), (right - left, bottom - top), GREY, CROSSED);
        cross(svg, [left, top, right, bottom]);
    }

    fn outline(&self, svg: &mut Svg, bounds: &Aabb, colour: &str, more: &str) {
        let [left, top, right, bottom] = self.corners(bounds);
        let around = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        svg.line(&around, colour, 1.2, more);
    }

    /// What is left of space, as far as it is in sight.
    fn clip(&self, svg: &mut Svg, clip: &Aabb, plane: Option<f32>) {
        if plane.is_some() {
            self.outline(svg, clip, INK, DOTTED);
        }
    }

    fn plane(&self, svg: &mut Svg, plane: Option<f32>) {
        if let Some(plane) = plane {
            let (x, top) = (self.x(plane), self.place.y);
            svg.line(&[(x, top - 6.0), (x, top + self.place.height + 6.0)], INK, 2.4, "");
        }
    }

    fn heading(&self, svg: &mut Svg, text: &str) {
        svg.text(
            (self.place.x, self.place.y - 14.0),
            Anchor::Start,
            14.0,
            INK,
            text,
            " font-weight=\"bold\"",
        );
    }
}
