//! A panel of a figure: points over two axes, a line through some of them, labels beside them. Ratios belong on
//! logarithmic axes: half and twice are equally far from 1. Only levels of a tree are counted on a linear one.

use super::labels::{self, Label, Obstacles, Rect};
use super::raster::text_width;
use super::svg::{Anchor, Shape, Svg};
use super::ticks::{linear_ticks, ticks};

/// Ink of texts.
pub const INK: &str = "#1a1a1a";
/// Ink of things in the background.
pub const GREY: &str = "#8c8c8c";
/// A broken line.
pub const DASHES: &str = " stroke-dasharray=\"4 3\"";
const GRID: &str = "#e6e6e6";
const FRAME: &str = "#b3b3b3";
/// Keeps lines from running through a text.
const HALO: &str = " stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\"";

/// Size of the texts below a title.
pub const SMALL: f64 = 13.0;

/// A sheet with a title and lines that say what was measured and how.
pub fn sheet((width, height): (f64, f64), title: &str, about: &[&str]) -> Svg {
    let mut svg = Svg::new(width, height, title);
    svg.text((20.0, 30.0), Anchor::Start, 17.0, INK, title, " font-weight=\"bold\"");
    for (line, text) in about.iter().enumerate() {
        svg.text((20.0, 51.0 + 18.0 * line as f64), Anchor::Start, SMALL, INK, text, "");
    }
    svg
}

/// A point of a panel.
#[derive(Clone, Debug)]
pub struct Point {
    /// Where, in the units of the axes.
    pub at: (f64, f64),
    /// Its shape.
    pub shape: Shape,
    /// Its colour.
    pub colour: &'static str,
    /// Outlined only.
    pub is_hollow: bool,
    /// The text beside it, if any.
    pub label: Option<String>,
    /// The ends of its intervals across and up, in the units of the axes.
    pub interval: Option<[(f64, f64); 2]>,
}

/// A line through points of a panel.
#[derive(Clone, Debug)]
pub struct Front {
    /// The corners, in the units of the axes.
    pub through: Vec<(f64, f64)>,
    /// How it is drawn.
    pub line: Line,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Its colour.
    pub colour: &'static str,
    /// Its width, pixels.
    pub width: f64,
    /// SVG attributes such as [`DASHES`].
    pub more: &'static str,
}

/// Ends of the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Across, least and greatest.
    pub x: (f64, f64),
    /// Up, least and greatest.
    pub y: (f64, f64),
}

impl Range {
    /// The range of some points and of 1, which ratios are compared with, with a margin.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a Point>) -> Self {
        Self::from((1.0, 1.0), points)
    }

    /// The range of `first` and some points, with a margin.
    pub fn from<'a>((x, y): (f64, f64), points: impl IntoIterator<Item = &'a Point>) -> Self {
        let mut range = Self { x: (x, x), y: (y, y) };
        for Point { at: (x, y), interval, .. } in points {
            let [across, up] = interval.unwrap_or([(*x, *x), (*y, *y)]);
            range.x = (range.x.0.min(across.0), range.x.1.max(across.1));
            range.y = (range.y.0.min(up.0), range.y.1.max(up.1));
        }
        let wider = |(least, most): (f64, f64), least_margin: f64| {
            let margin = (most / least).powf(0.09).max(least_margin);
            (least / margin, most * margin)
        };
        Self { x: wider(range.x, 1.05), y: wider(range.y, 1.02) }
    }
}

/// How the axis across is divided; the one upwards is logarithmic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Across {
    /// By ratios.
    #[default]
    Logarithmic,
    /// Evenly, in whole numbers.
    Linear,
}

/// One panel of a figure.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Above the panel.
    pub title: String,
    /// Names of the axes: across, up.
    pub axes: (String, String),
    /// Their ends.
    pub range: Range,
    /// How the first is divided.
    pub across: Across,
    /// The lines, drawn first.
    pub fronts: Vec<Front>,
    /// The points, filled ones above hollow ones, of these the last above the others.
    pub points: Vec<Point>,
    /// Size of the texts, pixels.
    pub font: f64,
}

impl Panel {
    /// Draws the panel's inside over `area`; axes and title stand around it.
    pub fn draw(&self, svg: &mut Svg, area: Rect) {
        let scale = |value: f64, (least, most): (f64, f64)| (value / least).ln() / (most / least).ln();
        let x = |value: f64| match self.across {
            Across::Logarithmic => area.x + area.width * scale(value, self.range.x),
            Across::Linear => {
                let (least, most) = self.range.x;
                area.x + area.width * (value - least) / (most - least)
            }
        };
        let y = |value: f64| area.y + area.height * (1.0 - scale(value, self.range.y));
        let place = |(a, b): (f64, f64)| (x(a), y(b));
        self.draw_axes(svg, area, &x, &y);

        let mut segments = Vec::new();
        for front in &self.fronts {
            let corners: Vec<(f64, f64)> = front.through.iter().map(|&at| place(at)).collect();
            segments.extend(corners.windows(2).map(|pair| (pair[0], pair[1])));
            let Line { colour, width, more } = front.line;
            svg.line(&corners, colour, width, more);
        }

        let mut bars = Vec::new();
        for Point { at, interval, colour, .. } in &self.points {
            let Some([across, up]) = *interval else { continue };
            for ends in [[(across.0, at.1), (across.1, at.1)], [(at.0, up.0), (at.0, up.1)]] {
                let ends = ends.map(place);
                bars.push((ends[0], ends[1]));
                svg.line(&ends, colour, 1.2, " stroke-opacity=\"0.4\"");
            }
        }

        let radius = 0.36 * self.font;
        let labelled: Vec<(&Point, &str)> =
            self.points.iter().rev().filter_map(|point| Some((point, point.label.as_deref()?))).collect();
        let labels: Vec<Label> = labelled
            .iter()
            .map(|(point, text)| Label {
                at: place(point.at),
                size: (text_width(text, self.font), 1.1 * self.font),
            })
            .collect();
        // Hollow points are drawn larger.
        let drawn = |point: &Point| if point.is_hollow { 1.55 * radius } else { radius };
        let markers: Vec<Rect> =
            self.points.iter().map(|point| Rect::around(place(point.at), 1.4 * drawn(point))).collect();
        let obstacles = Obstacles { points: &markers, lines: &segments, bars: &bars };
        let rects = labels::place(&labels, obstacles, area);
        for ((point, text), rect) in labelled.iter().zip(&rects) {
            let at = place(point.at);
            if let Some((from, to)) = labels::leader(at, rect) {
                svg.line(&[from, to], GREY, 0.7, "");
            }
            let ink = if point.is_hollow { "#6b6b6b" } else { INK };
            let baseline = rect.y + 0.82 * rect.height;
            // The text keeps to the side of its point, whatever font a viewer has.
            let (anchor, x) = if rect.x > at.0 {
                (Anchor::Start, rect.x)
            } else if rect.x + rect.width < at.0 {
                (Anchor::End, rect.x + rect.width)
            } else {
                (Anchor::Middle, rect.x + 0.5 * rect.width)
            };
            svg.text((x, baseline), anchor, self.font, ink, text, HALO);
        }
        // Hollow ones first and larger: of two at one place both are seen.
        for is_hollow in [true, false] {
            for point in self.points.iter().filter(|point| point.is_hollow == is_hollow) {
                svg.point(place(point.at), point.shape, drawn(point), point.colour, is_hollow);
            }
        }
    }

    fn draw_axes(&self, svg: &mut Svg, area: Rect, x: &dyn Fn(f64) -> f64, y: &dyn Fn(f64) -> f64) {
        let (right, bottom) = (area.x + area.width, area.y + area.height);
        let room = |length: f64| (length / (4.0 * self.font)).max(3.0) as usize;
        let ticks_across = match self.across {
            Across::Logarithmic => ticks(self.range.x, room(area.width)),
            Across::Linear => linear_ticks(self.range.x, room(area.width)),
        };
        for (tick, text) in ticks_across {
            let strong = tick == 1.0 && self.across == Across::Logarithmic;
            svg.line(&[(x(tick), area.y), (x(tick), bottom)], if strong { FRAME } else { GRID }, 1.0, "");
            svg.text((x(tick), bottom + 1.4 * self.font), Anchor::Middle, self.font, INK, &text, "");
        }
        for (tick, text) in ticks(self.range.y, room(area.height)) {
            let strong = tick == 1.0;
            svg.line(&[(area.x, y(tick)), (right, y(tick))], if strong { FRAME } else { GRID }, 1.0, "");
            svg.text(
                (area.x - 0.5 * self.font, y(tick) + 0.35 * self.font),
                Anchor::End,
                self.font,
                INK,
                &text,
                "",
            );
        }
        svg.frame((area.x, area.y), (area.width, area.height), FRAME);
        let middle = (area.x + 0.5 * area.width, area.y + 0.5 * area.height);
        if !self.axes.0.is_empty() {
            svg.text((middle.0, bottom + 3.1 * self.font), Anchor::Middle, self.font, INK, &self.axes.0, "");
        }
        if !self.axes.1.is_empty() {
            let at = (area.x - 3.6 * self.font, middle.1);
            let turn = format!(" transform=\"rotate(-90 {:.2} {:.2})\"", at.0, at.1);
            svg.text(at, Anchor::Middle, self.font, INK, &self.axes.1, &turn);
        }
        if !self.title.is_empty() {
            let at = (area.x, area.y - 0.6 * self.font);
            svg.text(at, Anchor::Start, 1.1 * self.font, INK, &self.title, " font-weight=\"bold\"");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINT: Point = Point {
        at: (3.0, 0.8),
        shape: Shape::Circle,
        colour: INK,
        is_hollow: false,
        label: None,
        interval: None,
    };

    #[test]
    fn ranges_hold_their_points_and_one() {
        let range = Range::of([&POINT]);
        assert!(range.x.0 < 1.0 && range.x.1 > 3.0 && range.y.0 < 0.8 && range.y.1 > 1.0);
    }

    #[test]
    fn of_two_points_at_one_place_both_are_seen() {
        let points = vec![POINT, Point { is_hollow: true, ..POINT }];
        let range = Range::of(&points);
        let (title, axes, fronts) = (String::new(), (String::new(), String::new()), Vec::new());
        let panel = Panel { title, axes, range, across: Across::Logarithmic, fronts, points, font: 10.0 };
        let mut svg = sheet((100.0, 100.0), "", &[]);
        panel.draw(&mut svg, Rect { x: 0.0, y: 0.0, width: 100.0, height: 100.0 });
        let svg = svg.finish();
        let circles: Vec<&str> = svg.lines().filter(|line| line.starts_with("<circle")).collect();
        assert!(circles[0].contains("r=\"5.58\"") && circles[0].contains("fill-opacity"), "{circles:?}");
        assert!(circles[1].contains("r=\"3.60\"") && !circles[1].contains("fill-opacity"), "{circles:?}");
    }
}
