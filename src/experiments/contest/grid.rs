//! The grid of alpha and delta of equation 2 (paper 5.4): its points, and what the paper says of them judged scene by
//! scene.

use super::experiment::{Comparison, Expectation, Families};
use super::variants::changed;
use crate::bench::row::Row;
use crate::builders::PhrConfig;
use crate::report::figures::{Figure, SceneFigures, Under, scenes};
use crate::report::grid::Grid;
use crate::report::means::Ratios;
use crate::report::plot::pareto::front;

/// The paper's values.
const ALPHAS: [f32; 4] = [0.45, 0.5, 0.55, 0.65];
const DELTAS: [f32; 6] = [5.0, 6.0, 7.0, 8.0, 9.0, 10.0];

/// A point may trace so much slower than a preset and still count as equal to it.
const EQUAL: f64 = 1.01;

fn name(alpha: f32, delta: f32) -> String {
    changed("phr-hq", &format!("alpha={alpha}+delta={delta}"))
}

fn label(alpha: f32, delta: f32) -> String {
    format!("{alpha}, {delta}")
}

fn points() -> impl Iterator<Item = (f32, f32)> {
    ALPHAS.into_iter().flat_map(|alpha| DELTAS.map(|delta| (alpha, delta)))
}

fn preset(config: &PhrConfig) -> String {
    name(config.alpha, config.delta)
}

/// A builder for each point.
pub fn variants() -> Vec<String> {
    points().map(|(alpha, delta)| name(alpha, delta)).collect()
}

/// What the paper compares: (0.5, 7) with PHR-HQ, (0.5, 5) with PHR-Fast.
pub fn comparisons() -> Vec<Comparison> {
    let expected = |says, figure, range, scenes| Expectation { says, figure, range, scenes };
    const LARGE: &[&str] = &["San Miguel", "Powerplant"];
    let of_hq = [
        expected("it builds about 35 % faster there", Figure::Build, (0.55, 0.75), LARGE),
        expected("it traces no slower there", Figure::Trace, (0.0, 1.0), LARGE),
    ];
    let of_fast = [
        expected("it builds 9 % faster in Conference", Figure::Build, (0.86, 0.96), &["Conference"]),
        expected("it builds 33 % faster in Hairball", Figure::Build, (0.57, 0.77), &["Hairball"]),
        expected("it traces as fast in both", Figure::Trace, (0.97, 1.03), &["Conference", "Hairball"]),
    ];
    vec![
        Comparison { changed: name(0.5, 7.0), base: preset(&PhrConfig::HQ), expected: of_hq.into() },
        Comparison { changed: name(0.5, 5.0), base: preset(&PhrConfig::FAST), expected: of_fast.into() },
    ]
}

/// A line for each alpha, by delta.
pub fn families() -> Families {
    let line = |alpha: f32| {
        let points = DELTAS.map(|delta| (name(alpha, delta), label(alpha, delta)));
        (format!("alpha {alpha}, delta 5 to 10"), points.into())
    };
    Families { base: preset(&PhrConfig::HQ), lines: ALPHAS.map(line).into() }
}

/// The front in the mean, in words, and each scene's best points beside the presets.
pub fn findings(rows: &[Row], width: u32, under: &Under) -> String {
    let base = preset(&PhrConfig::HQ);
    let mean =
        |builder: &str, figure| Ratios::to((&base, width), rows, (builder, width), figure, under).geometric();
    let known: Vec<((f32, f32), (f64, f64))> = points()
        .filter_map(|(alpha, delta)| {
            let builder = name(alpha, delta);
            Some(((alpha, delta), (mean(&builder, Figure::Build)?, mean(&builder, Figure::Trace)?)))
        })
        .collect();
    if known.is_empty() {
        return String::new();
    }
    let on_front = front(&known.iter().map(|(_, at)| *at).collect::<Vec<_>>());
    let told = |((alpha, delta), (build, trace)): ((f32, f32), (f64, f64))| {
        format!("({alpha}, {delta}): build {build:.2}, trace {trace:.3}")
    };
    let is_on_front = |config: &PhrConfig| {
        let on = on_front.iter().any(|&i| known[i].0 == (config.alpha, config.delta));
        if on { "is on it" } else { "is not" }
    };
    let mut text = format!(
        "The front in the mean over scenes, relative to PHR-HQ: {}. PHR-Fast {}, PHR-HQ {}.\n\n",
        on_front.iter().map(|&i| told(known[i])).collect::<Vec<_>>().join("; "),
        is_on_front(&PhrConfig::FAST),
        is_on_front(&PhrConfig::HQ)
    );
    let mut grid =
        Grid::new(["scene", "as PHR-HQ", "build", "trace", "as PHR-Fast", "build", "trace", "on the front"]);
    for scene in scenes(rows) {
        let figures = SceneFigures::of(rows, &scene);
        let mut line = vec![scene.clone()];
        for config in [PhrConfig::HQ, PhrConfig::FAST] {
            line.extend(best(&figures, &preset(&config), width, under));
        }
        let at = |builder: &str| {
            let ratio = |figure| {
                figures.ratio_to((&base, width), (builder, width), figure, under).map(|ratio| ratio.value)
            };
            Some((ratio(Figure::Build)?, ratio(Figure::Trace)?))
        };
        let here: Vec<((f32, f32), (f64, f64))> =
            points().filter_map(|(alpha, delta)| Some(((alpha, delta), at(&name(alpha, delta))?))).collect();
        let on_front = front(&here.iter().map(|(_, at)| *at).collect::<Vec<_>>());
        let names = on_front.into_iter().map(|i| format!("({}, {})", here[i].0.0, here[i].0.1));
        line.push(names.collect::<Vec<_>>().join(" "));
        grid.push(line);
    }
    text += &format!(
        "{}\nas PHR-HQ, as PHR-Fast: the point (alpha, delta) that builds fastest of those that trace at most 1 % slower than \
         the preset, with its build and trace time relative to the preset's.\n",
        grid.markdown()
    );
    text
}

/// The point of a scene that builds fastest of those that trace as the preset, and its build and trace time relative to
/// that.
fn best(figures: &SceneFigures<'_>, preset: &str, width: u32, under: &Under) -> [String; 3] {
    let ratio = |builder: &str, figure| {
        Some(figures.ratio_to((preset, width), (builder, width), figure, under)?.value)
    };
    let found = points()
        .filter_map(|(alpha, delta)| {
            let builder = name(alpha, delta);
            Some(((alpha, delta), ratio(&builder, Figure::Build)?, ratio(&builder, Figure::Trace)?))
        })
        .filter(|(_, _, trace)| *trace <= EQUAL)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    found.map_or_else(Default::default, |((alpha, delta), build, trace)| {
        [format!("({alpha}, {delta})"), format!("{build:.2}"), format!("{trace:.2}")]
    })
}
