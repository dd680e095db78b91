//! Draws comparisons: a line for each, a column for each figure, the scenes as small points, their mean with its
//! interval.

use super::compared::{Compared, Mean, name};
use super::experiment::Experiment;
use crate::bench::row::Row;
use crate::report::figures::{Figure, SceneFigures, Under};
use crate::report::plot::chart::{GREY, INK, SMALL, sheet};
use crate::report::plot::raster::text_width;
use crate::report::plot::svg::{Anchor, Shape};
use crate::report::plot::ticks::ticks;

const COLUMN: f64 = 250.0;
const GAP: f64 = 34.0;
const LINE: f64 = 46.0;
const TOP: f64 = 128.0;
const COLOUR: &str = "#0072b2";

/// The figure over trees of `width`; `None` if there is nothing to compare.
pub fn draw(experiment: &Experiment, rows: &[Row], width: u32, under: &Under) -> Option<String> {
    let comparisons = (experiment.comparisons)();
    let scenes = SceneFigures::all(rows);
    let all: Vec<Compared<'_>> = comparisons
        .iter()
        .filter_map(|comparison| Compared::of(comparison, experiment.figures, &scenes, width, under))
        .collect();
    if all.is_empty() {
        return None;
    }
    let names = all.iter().flat_map(|it| [it.comparison.changed.clone(), against(&it.comparison.base)]);
    let left = 44.0 + names.map(|name| text_width(&name, SMALL)).fold(0.0, f64::max);
    let bottom = TOP + all.len() as f64 * LINE;
    let is_measured = |figure: &&Figure| all.iter().any(|compared| compared.is_measured(**figure));
    let figures: Vec<&Figure> = experiment.figures.iter().filter(is_measured).collect();
    let count = scenes.len();
    let threads = rows.first().map_or(0, |row| row.threads);
    let noun = if count == 1 { "scene" } else { "scenes" };
    let about = format!(
        "{count} {noun} (grey), their geometric mean with its 95 % interval (blue); {width}-wide trees, {threads} threads, \
         logarithmic"
    );
    let traces = format!("traces: {}", under.about());
    let columns = left + figures.len() as f64 * (COLUMN + GAP);
    // No narrower than what is written beside the columns.
    let size = (
        columns.max(2.0 * GAP + text_width(&about, SMALL)).max(left + GAP + text_width(BELOW, SMALL)),
        bottom + 56.0,
    );
    let mut svg = sheet(size, experiment.about, &[&about, &traces]);
    for (line, compared) in all.iter().enumerate() {
        let y = TOP + (line as f64 + 0.5) * LINE;
        let comparison = compared.comparison;
        svg.text((left - 14.0, y - 3.0), Anchor::End, SMALL, INK, &comparison.changed, "");
        svg.text((left - 14.0, y + 13.0), Anchor::End, SMALL, "#6b6b6b", &against(&comparison.base), "");
    }
    for (column, &figure) in figures.iter().enumerate() {
        let x0 = left + column as f64 * (COLUMN + GAP);
        let of = |compared: &Compared<'_>| compared.of_figure(*figure).cloned().unwrap_or_default();
        let values = all.iter().flat_map(|it| of(it).0).map(|ratio| ratio.value);
        let ends = all.iter().filter_map(|it| Mean::of(&of(it))?.interval);
        let values: Vec<f64> = values.chain(ends.flat_map(|ends| [ends.low, ends.high])).collect();
        let (least, most) = values
            .into_iter()
            .fold((0.95_f64, 1.05_f64), |(low, high), value| (low.min(value), high.max(value)));
        let margin = (most / least).powf(0.05);
        let (least, most) = (least / margin, most * margin);
        let x = |value: f64| x0 + COLUMN * (value / least).ln() / (most / least).ln();
        svg.text(
            (x0, TOP - 12.0),
            Anchor::Start,
            14.0,
            INK,
            &format!("{}, relative", name(*figure)),
            " font-weight=\"bold\"",
        );
        for (tick, text) in ticks((least, most), 5) {
            let colour = if tick == 1.0 { GREY } else { "#e6e6e6" };
            svg.line(&[(x(tick), TOP), (x(tick), bottom)], colour, 1.0, "");
            svg.text((x(tick), bottom + 18.0), Anchor::Middle, SMALL, INK, &text, "");
        }
        svg.frame((x0, TOP), (COLUMN, bottom - TOP), "#b3b3b3");
        for (line, compared) in all.iter().enumerate() {
            let y = TOP + (line as f64 + 0.5) * LINE;
            let ratios = of(compared);
            for ratio in &ratios.0 {
                svg.point((x(ratio.value), y + 9.0), Shape::Circle, 2.6, GREY, true);
            }
            let Some(mean) = Mean::of(&ratios) else { continue };
            if let Some(interval) = mean.interval {
                svg.line(&[(x(interval.low), y - 6.0), (x(interval.high), y - 6.0)], COLOUR, 2.5, "");
            }
            svg.point((x(mean.value), y - 6.0), Shape::Diamond, 5.0, COLOUR, false);
        }
    }
    svg.text((left, bottom + 40.0), Anchor::Start, SMALL, INK, BELOW, "");
    Some(svg.finish())
}

/// What the axes mean.
const BELOW: &str = "left of 1: less time, cost or steps than the builder in grey; steps: nodes visited and leaf blocks tested per ray";

fn against(base: &str) -> String {
    format!("relative to {base}")
}
