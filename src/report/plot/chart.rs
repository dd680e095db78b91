//! A panel of a figure: points over two logarithmic axes, a line through some of them, labels beside them.
//! Ratios belong on logarithmic axes: half and twice are equally far from 1.

use super::labels::{self, Label, Rect};
use super::raster::text_width;
use super::svg::{Anchor, Shape, Svg};

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

/// Shape and colour of a builder by its family, the same in all figures; colours after Okabe and Ito, told apart by colour-blind readers too.
pub fn style(builder: &str) -> (Shape, &'static str) {
    match builder {
        name if name.starts_with("embree") => (Shape::Circle, "#0072b2"),
        name if name.starts_with("phr") => (Shape::Up, "#d55e00"),
        name if name.starts_with("hunt") => (Shape::Square, "#009e73"),
        name if name.starts_with("aac") => (Shape::Diamond, "#cc79a7"),
        _ => (Shape::Down, "#000000"),
    }
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
        for Point { at: (x, y), .. } in points {
            range.x = (range.x.0.min(*x), range.x.1.max(*x));
            range.y = (range.y.0.min(*y), range.y.1.max(*y));
        }
        let wider = |(least, most): (f64, f64), least_margin: f64| {
            let margin = (most / least).powf(0.09).max(least_margin);
            (least / margin, most * margin)
        };
        Self { x: wider(range.x, 1.05), y: wider(range.y, 1.02) }
    }
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
    /// The lines, drawn first.
    pub fronts: Vec<Front>,
    /// The points, the last above the others.
    pub points: Vec<Point>,
    /// Size of the texts, pixels.
    pub font: f64,
}

impl Panel {
    /// Draws the panel's inside over `area`; axes and title stand around it.
    pub fn draw(&self, svg: &mut Svg, area: Rect) {
        let scale = |value: f64, (least, most): (f64, f64)| (value / least).ln() / (most / least).ln();
        let x = |value: f64| area.x + area.width * scale(value, self.range.x);
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
        let markers: Vec<Rect> =
            self.points.iter().map(|point| Rect::around(place(point.at), 1.4 * radius)).collect();
        let rects = labels::place(&labels, &markers, &segments, area);
        for ((point, text), rect) in labelled.iter().zip(&rects) {
            let (at, near) = (place(point.at), rect.nearest(place(point.at)));
            if (at.0 - near.0).hypot(at.1 - near.1) > 11.0 {
                svg.line(&[at, near], GREY, 0.7, "");
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
        for point in &self.points {
            svg.point(place(point.at), point.shape, radius, point.colour, point.is_hollow);
        }
    }

    fn draw_axes(&self, svg: &mut Svg, area: Rect, x: &dyn Fn(f64) -> f64, y: &dyn Fn(f64) -> f64) {
        let (right, bottom) = (area.x + area.width, area.y + area.height);
        let room = |length: f64| (length / (4.0 * self.font)).max(3.0) as usize;
        for (tick, text) in ticks(self.range.x, room(area.width)) {
            let strong = tick == 1.0;
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

/// Round values within `range`, at most `room` of them: of the finest series that is not too fine.
fn ticks((least, most): (f64, f64), room: usize) -> Vec<(f64, String)> {
    let decades = |steps: &[f64]| -> Vec<f64> {
        (-6..7).flat_map(|power| steps.iter().map(move |step| step * 10f64.powi(power))).collect()
    };
    let even = |step: f64| -> Vec<f64> { (1..400).map(|i| step * f64::from(i)).collect() };
    let series = [
        even(0.02),
        even(0.05),
        even(0.1),
        even(0.2),
        decades(&[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0]),
        decades(&[1.0, 1.5, 2.0, 3.0, 5.0, 7.0]),
        decades(&[1.0, 2.0, 5.0]),
        decades(&[1.0]),
    ];
    let within = |values: &[f64]| -> Vec<f64> {
        values.iter().copied().filter(|&v| v >= least * 0.999 && v <= most * 1.001).collect()
    };
    let fitting = series.iter().map(|values| within(values)).find(|ticks| {
        // Even steps crowd at the upper end of a logarithmic axis.
        let closest = ticks.windows(2).map(|pair| (pair[1] / pair[0]).ln()).fold(f64::INFINITY, f64::min);
        ticks.len() >= 2 && ticks.len() <= room && closest * room as f64 >= 0.8 * (most / least).ln()
    });
    let ticks = fitting.unwrap_or_else(|| within(&[least, most]));
    ticks
        .into_iter()
        .map(|tick| {
            let text = format!("{tick:.3}");
            let text = text.trim_end_matches('0').trim_end_matches('.').to_owned();
            (text.parse().unwrap_or(tick), text)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        let texts = |range, room| ticks(range, room).into_iter().map(|tick| tick.1).collect::<Vec<_>>();
        assert_eq!(texts((0.45, 4.0), 10), ["0.5", "0.6", "0.8", "1", "1.2", "1.5", "2", "2.5", "3", "4"]);
        assert_eq!(texts((0.9, 1.45), 7), ["0.9", "1", "1.1", "1.2", "1.3", "1.4"]);
        assert_eq!(texts((0.02, 300.0), 5), ["0.1", "1", "10", "100"]);
    }

    #[test]
    fn ranges_hold_their_points_and_one() {
        let point =
            Point { at: (3.0, 0.8), shape: Shape::Circle, colour: INK, is_hollow: false, label: None };
        let range = Range::of([&point]);
        assert!(range.x.0 < 1.0 && range.x.1 > 3.0 && range.y.0 < 0.8 && range.y.1 > 1.0);
    }
}
