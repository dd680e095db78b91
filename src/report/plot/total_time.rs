//! The figure of advice: total time, build + rays / speed, over the number of rays, and the same relative to the best
//! tree, in which differences are seen. Trees that win somewhere are named beside their lines, and in a key: some win
//! where the panels do not reach.

use super::Drawing;
use super::chart::{Across, DASHES, Front, INK, Line, Panel, Point, Range, SMALL, sheet};
use super::families::family_of;
use super::key::in_lines;
use super::labels::Rect;
use super::raster::text_width;
use super::svg::{Anchor, Svg};
use crate::bench::quick::line::{TotalTime, least_at};
use crate::report::advice::{Advice, Known};

/// Least and greatest number of rays, powers of ten.
const DECADES: (i32, i32) = (4, 10);
/// Points of a curve in each decade.
const STEPS: i32 = 32;
/// Ratios shown.
const MOST: f64 = 2.0;
/// Width of the sheet, its height without a key, and its margin.
const SHEET: [f64; 3] = [1160.0, 548.0, 20.0];
/// Height of a row of the key, length of its lines.
const KEY: [f64; 2] = [22.0, 30.0];
/// Colours of winners in their order, after Okabe and Ito: most are of one family, whose colour would not tell them
/// apart.
const COLOURS: [&str; 7] = ["#000000", "#0072b2", "#009e73", "#d55e00", "#cc79a7", "#e69f00", "#56b4e9"];

/// The figure; `None` without any tree.
pub fn total_time(advice: &Advice) -> Option<Drawing> {
    let lines = advice.lines();
    let only: Vec<TotalTime> = lines.iter().map(|(_, line)| *line).collect();
    let best = |rays: f64| least_at(&only, rays).map(|i| only[i].at(rays));
    best(1.0)?;
    let winners: Vec<&Known> = advice.winners().into_iter().map(|(known, _)| known).collect();
    let place = |known: &Known| winners.iter().position(|winner| std::ptr::eq(*winner, known));
    let colour = |place: usize| COLOURS[place % COLOURS.len()];
    let budgets: Vec<f64> = (STEPS * DECADES.0..=STEPS * DECADES.1)
        .map(|step| 10f64.powf(f64::from(step) / f64::from(STEPS)))
        .collect();
    let (mut totals, mut ratios) = (Vec::new(), Vec::new());
    let line_of = |known: &Known| {
        let more = if known.width == 8 { "" } else { DASHES };
        match place(known) {
            Some(place) => Line { colour: colour(place), width: 2.0, more },
            None => Line { colour: "#d0d0d0", width: 1.0, more },
        }
    };
    let mut order: Vec<usize> = (0..lines.len()).collect();
    // Winners are drawn above the others.
    order.sort_by_key(|&i| place(lines[i].0).is_some());
    for i in order {
        let (known, line) = lines[i];
        let line_style = line_of(known);
        let million = |rays: &f64| 1e-6 * rays;
        let total = budgets.iter().map(|rays| (million(rays), 1e-3 * line.at(*rays))).collect();
        totals.push(Front { through: total, line: line_style });
        let ratio =
            |rays: &f64| Some((million(rays), line.at(*rays) / best(*rays)?)).filter(|at| at.1 <= MOST);
        // What leaves the panel comes back as another piece.
        let pieces = budgets.split(|rays| ratio(rays).is_none());
        for piece in pieces.filter(|piece| piece.len() > 1) {
            ratios.push(Front { through: piece.iter().filter_map(ratio).collect(), line: line_style });
        }
    }
    let ends = (1e-6 * budgets[0], 1e-6 * budgets[budgets.len() - 1]);
    let marks = marks(advice, ends);
    let at = |ratio: bool| -> Vec<Point> {
        let mark = |(known, rays): &(&Known, f64)| {
            let shape = family_of(&known.builder).shape;
            let colour = colour(place(known).unwrap_or_default());
            let total = best(1e6 * rays).unwrap_or(f64::NAN);
            let y = if ratio { 1.0 } else { 1e-3 * total };
            let (is_hollow, label) = (known.width == 8, Some(known.name()));
            Point { at: (*rays, y), interval: None, shape, colour, is_hollow, label }
        };
        marks.iter().map(mark).collect()
    };
    let heights = totals.iter().flat_map(|front| &front.through).map(|at| at.1);
    let heights = heights.fold((f64::INFINITY, 0.0f64), |(low, high), y| (low.min(y), high.max(y)));
    let panel = |title: &str, axis: &str, y, fronts, points| Panel {
        title: title.into(),
        axes: ("million rays".into(), axis.into()),
        range: Range { x: ends, y },
        across: Across::Logarithmic,
        fronts,
        points,
        font: 13.0,
    };
    let title = format!("Which builder for {}: build + rays / speed", advice.scene);
    let about = [
        advice.origin.as_str(),
        "named: the trees that are best somewhere, where they begin to be; 4-wide trees broken, hollow points 8-wide",
    ];
    let mut entries: Vec<(Line, String)> =
        winners.iter().map(|&known| (line_of(known), known.name())).collect();
    if let Some(other) = lines.iter().find(|entry| place(entry.0).is_none()) {
        entries.push((Line { more: "", ..line_of(other.0) }, "best nowhere".into()));
    }
    let [width, top, margin] = SHEET;
    let lengths = entries.iter().map(|(_, text)| KEY[1] + 30.0 + text_width(text, SMALL));
    let places = in_lines(lengths, (margin, top + 0.5 * KEY[0]), width - margin + 24.0, KEY[0]);
    let end = places.last().map_or(SHEET[1], |(_, y)| y + KEY[0]);
    let mut svg = sheet((SHEET[0], end), &title, &about);
    for ((line, text), (x, y)) in entries.iter().zip(places) {
        key(&mut svg, (x, y), *line, text);
    }
    let total = panel("total time", "seconds", (0.8 * heights.0, 1.2 * heights.1), totals, at(false));
    total.draw(&mut svg, Rect { x: 76.0, y: 112.0, width: 480.0, height: 380.0 });
    let ratio = panel("relative to the best", "total time / best", (0.97, MOST), ratios, at(true));
    ratio.draw(&mut svg, Rect { x: 650.0, y: 112.0, width: 480.0, height: 380.0 });
    Some(Drawing { name: "advice", svg: svg.finish() })
}

/// An entry of the key: how a line looks, and what it is.
fn key(svg: &mut Svg, (x, y): (f64, f64), line: Line, text: &str) {
    let Line { colour, width, more } = line;
    svg.line(&[(x, y), (x + KEY[1], y)], colour, width, more);
    svg.text((x + KEY[1] + 6.0, y + 4.5), Anchor::Start, SMALL, INK, text, "");
}

/// Where each winner begins to be the best, in million rays within `ends`.
fn marks(advice: &Advice, ends: (f64, f64)) -> Vec<(&Known, f64)> {
    let winners = advice.winners();
    let mut marks: Vec<(&Known, f64)> = Vec::new();
    for (i, (known, from)) in winners.iter().enumerate() {
        let to = winners.get(i + 1).map_or(f64::INFINITY, |next| 1e-6 * next.1);
        let at = (1e-6 * from).max(1.5 * ends.0);
        if at < to && at < ends.1 {
            marks.push((known, at));
        }
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::advice::tests::advice;

    #[test]
    fn winners_are_named_in_both_panels_and_the_key() {
        let drawing = total_time(&advice()).unwrap();
        for name in ["lbvh", "phr-speed / 8", "phr-best / 8"] {
            assert_eq!(drawing.svg.matches(&format!(">{name}<")).count(), 3, "{name}");
        }
        assert_eq!(drawing.svg.matches(">best nowhere<").count(), 1);
        assert!(!drawing.svg.contains(">aac<") && drawing.svg.contains("made by hand"));
        let nothing = Advice { trees: Vec::new(), ..advice() };
        assert!(total_time(&nothing).is_none());
    }

    #[test]
    fn a_winner_left_of_the_panels_is_named_in_the_key() {
        let mut advice = advice();
        let line = Some(TotalTime::exact(9.9, 5000.0));
        advice.trees.push(Known { builder: "embree-morton".into(), line, ..advice.trees[0].clone() });
        let svg = total_time(&advice).unwrap().svg;
        assert_eq!(svg.matches(">embree-morton<").count(), 1, "{svg}");
        assert!(svg.contains(&format!("stroke=\"{}\" stroke-width=\"2\"{DASHES}", COLOURS[0])), "{svg}");
    }
}
