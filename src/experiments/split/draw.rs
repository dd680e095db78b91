//! Draws a split in two dimensions: the boxes of the cut, projected along the axis in which they tell least.

use super::choose::axes;
use super::{Kind, Picture};
use crate::geometry::Aabb;
use crate::report::plot::chart::{DASHES, GREY, INK, SMALL, sheet};
use crate::report::plot::labels::Rect;
use crate::report::plot::svg::{Anchor, Svg};

/// Colours of the two sides and of nodes on both, after Okabe and Ito.
const SIDES: [&str; 2] = ["#0072b2", "#d55e00"];
const BOTH: &str = "#009e73";
const COLUMN: f64 = 400.0;
const GAP: f64 = 44.0;
const TOP: f64 = 118.0;
const LEFT: f64 = 26.0;

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
    let size = (LEFT + 3.0 * (COLUMN + GAP), TOP + 2.0 * height + 150.0);
    let thousands = (picture.triangles as f64 / 1000.0).round();
    let title = format!("{} of {} in {}", picture.kind, picture.builder, picture.scene);
    let name = |axis: usize| ["x", "y", "z"][axis];
    let about = format!(
        "{thousands} k triangles; a cut of {} nodes below {} binary splits; {} across, {} up, seen along {}",
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
    let middle = TOP + 0.5 * (height + 60.0);

    let whole = at(0.0, middle);
    whole.heading(&mut svg, &format!("1. find the split of the {} nodes", split.cut.len()));
    for node in &split.cut {
        let sides = membership(picture, node);
        let colour = match sides {
            [true, true] => BOTH,
            [true, false] => SIDES[0],
            _ => SIDES[1],
        };
        whole.node(&mut svg, node, colour, false);
    }
    whole.plane(&mut svg, split.plane);

    for (side, top) in [(0, TOP), (1, lower)] {
        let word = ["left", "right"][side];
        let (nodes, refined) = (&split.sides[side], &split.refined[side]);
        let parted = at(1.0, top);
        let clipped = if split.plane.is_some() { ", clipped" } else { "" };
        parted.heading(&mut svg, &format!("2. {word}: {} nodes{clipped}", nodes.len()));
        parted.clip(&mut svg, &split.clips[side], split.plane);
        for node in nodes {
            let is_on_both = split.plane.is_some() && !split.cut.contains(node);
            parted.node(&mut svg, node, if is_on_both { BOTH } else { SIDES[side] }, false);
        }
        parted.plane(&mut svg, split.plane);

        let finer = at(2.0, top);
        let opened = nodes.iter().filter(|node| !refined.contains(node)).count();
        let noun = if opened == 1 { "node" } else { "nodes" };
        finer.heading(&mut svg, &format!("3. refined: {} nodes, {opened} {noun} opened", refined.len()));
        finer.clip(&mut svg, &split.clips[side], split.plane);
        for node in nodes.iter().filter(|node| !refined.contains(node)) {
            finer.outline(&mut svg, node, GREY);
        }
        for node in refined {
            finer.node(&mut svg, node, SIDES[side], !nodes.contains(node));
        }
        finer.plane(&mut svg, split.plane);
    }
    svg.finish()
}

/// On which sides a node of the cut is.
fn membership(picture: &Picture, node: &Aabb) -> [bool; 2] {
    let split = &picture.split;
    match split.plane {
        Some(plane) => {
            let (min, max) = (node.min[split.axis], node.max[split.axis]);
            [min < plane || max <= plane, max > plane]
        }
        None => [0, 1].map(|side| split.sides[side].contains(node)),
    }
}

fn key(svg: &mut Svg, kind: Kind) {
    let mut x = LEFT;
    let mut entry = |colour: &str, opacity: &str, text: &str, width: f64| {
        let more = format!(" fill-opacity=\"{opacity}\" stroke=\"{colour}\" stroke-width=\"1.3\"");
        svg.fill((x, 66.0), (20.0, 13.0), colour, &more);
        svg.text((x + 27.0, 77.0), Anchor::Start, SMALL, INK, text, "");
        x += width;
    };
    entry(SIDES[0], "0.14", "left", 84.0);
    entry(SIDES[1], "0.14", "right", 92.0);
    entry(SIDES[0], "0.5", "child of a node that was opened", 270.0);
    if kind == Kind::Spatial {
        entry(BOTH, "0.14", "on both sides", 150.0);
    }
    svg.line(&[(x, 66.0), (x + 20.0, 66.0), (x + 20.0, 79.0), (x, 79.0), (x, 66.0)], GREY, 1.2, DASHES);
    svg.text((x + 27.0, 77.0), Anchor::Start, SMALL, INK, "opened", "");
    if kind == Kind::Spatial {
        svg.line(&[(x + 106.0, 64.0), (x + 106.0, 81.0)], INK, 2.4, "");
        svg.text((x + 114.0, 77.0), Anchor::Start, SMALL, INK, "plane", "");
        svg.line(
            &[(x + 176.0, 66.0), (x + 196.0, 66.0), (x + 196.0, 79.0), (x + 176.0, 79.0), (x + 176.0, 66.0)],
            INK,
            1.0,
            " stroke-dasharray=\"2 2\"",
        );
        svg.text((x + 203.0, 77.0), Anchor::Start, SMALL, INK, "clip box", "");
    }
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
        x.clamp(self.place.x, self.place.x + self.place.width)
    }

    fn y(&self, value: f32) -> f64 {
        let y = self.place.y + self.place.height - self.scale * (f64::from(value) - self.from[1]);
        y.clamp(self.place.y, self.place.y + self.place.height)
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

    fn node(&self, svg: &mut Svg, bounds: &Aabb, colour: &str, is_child: bool) {
        let [left, top, right, bottom] = self.corners(bounds);
        let opacity = if is_child { "0.5" } else { "0.14" };
        let more = format!(" fill-opacity=\"{opacity}\" stroke=\"{colour}\" stroke-width=\"1.3\"");
        svg.fill((left, top), (right - left, bottom - top), colour, &more);
    }

    fn outline(&self, svg: &mut Svg, bounds: &Aabb, colour: &str) {
        let [left, top, right, bottom] = self.corners(bounds);
        svg.line(
            &[(left, top), (right, top), (right, bottom), (left, bottom), (left, top)],
            colour,
            1.2,
            DASHES,
        );
    }

    /// What is left of space, as far as it is in sight.
    fn clip(&self, svg: &mut Svg, clip: &Aabb, plane: Option<f32>) {
        if plane.is_some() {
            let [left, top, right, bottom] = self.corners(clip);
            let dots = " stroke-dasharray=\"2 2\"";
            svg.line(
                &[(left, top), (right, top), (right, bottom), (left, bottom), (left, top)],
                INK,
                1.0,
                dots,
            );
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
