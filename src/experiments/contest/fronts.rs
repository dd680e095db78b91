//! Draws build time against steps and trace time: families of builders as lines through their points, and the front
//! through all.

use super::experiment::{Experiment, Families};
use crate::bench::row::Row;
use crate::report::figures::{Figure, SceneFigures, Under};
use crate::report::means::Ratios;
use crate::report::plot::chart::{Across, DASHES, Front, INK, Line, Panel, Point, Range, SMALL, sheet};
use crate::report::plot::labels::Rect;
use crate::report::plot::pareto::front;
use crate::report::plot::raster::text_width;
use crate::report::plot::svg::{Anchor, Shape, Svg};

/// Panels side by side.
const ABREAST: usize = 3;

/// Shapes and colours of lines, after Okabe and Ito.
const STYLES: [(Shape, &str); 4] = [
    (Shape::Up, "#d55e00"),
    (Shape::Square, "#009e73"),
    (Shape::Circle, "#0072b2"),
    (Shape::Diamond, "#cc79a7"),
];

/// The band behind the front.
const BAND: Line = Line { colour: "#dfe8d8", width: 9.0, more: " stroke-linejoin=\"round\"" };

/// What stands upwards in the panels of means: steps, which have no noise, and time.
const UPWARDS: [(Figure, &str); 2] = [(Figure::Steps, "steps of a ray"), (Figure::Trace, "trace time")];

/// The geometric means over scenes, a panel each for steps and for trace times; `None` without points.
pub fn mean(
    experiment: &Experiment,
    families: &Families,
    rows: &[Row],
    width: u32,
    under: &Under,
) -> Option<String> {
    let of_scenes = SceneFigures::all(rows);
    let count = of_scenes.len();
    let panel = |(figure, up): (Figure, &str)| {
        let at = |builder: &str| {
            let base = (families.base.as_str(), width);
            let mean = |figure| Ratios::among(&of_scenes, base, (builder, width), figure, under).geometric();
            Some((mean(Figure::Build)?, mean(figure)?))
        };
        let (fronts, points) = marks(families, at, true)?;
        let (range, axes, across) = (Range::of(&points), axes(families, up), Across::Logarithmic);
        Some(Panel { title: String::new(), axes, range, across, fronts, points, font: 12.0 })
    };
    let panels: Vec<Panel> = UPWARDS.into_iter().filter_map(panel).collect();
    if panels.is_empty() {
        return None;
    }
    let means = format!("geometric means of {count} {}", if count == 1 { "scene" } else { "scenes" });
    let (inside, pitch, left) = ((660.0, 530.0), 750.0, 78.0);
    let size = (f64::max(left + panels.len() as f64 * pitch, 860.0), 720.0);
    let mut svg = with_key(size, experiment, families, (rows, width, under), &means);
    for (index, panel) in panels.into_iter().enumerate() {
        let x = left + index as f64 * pitch;
        panel.draw(&mut svg, Rect { x, y: 124.0, width: inside.0, height: inside.1 });
    }
    Some(svg.finish())
}

/// A panel per scene, all with the same axes, by steps: single scenes' times are noise. Named are the points on the
/// front. `None` below two scenes.
pub fn by_scene(
    experiment: &Experiment,
    families: &Families,
    rows: &[Row],
    width: u32,
    under: &Under,
) -> Option<String> {
    let all: Vec<_> = SceneFigures::all(rows)
        .into_iter()
        .filter_map(|scene| {
            let at = |builder: &str| {
                let base = (families.base.as_str(), width);
                let ratio = |figure| scene.ratio_to(base, (builder, width), figure, under);
                Some((ratio(Figure::Build)?.value, ratio(Figure::Steps)?.value))
            };
            let marks = marks(families, at, false)?;
            Some((scene.scene().to_owned(), marks))
        })
        .collect();
    if all.len() < 2 {
        return None;
    }
    let range = Range::of(all.iter().flat_map(|(_, (_, points))| points));
    let (inside, pitch, left, top) = ((390.0, 280.0), (440.0, 346.0), 74.0, 132.0);
    let (count, abreast) = (all.len(), all.len().min(ABREAST));
    let size = (left + abreast as f64 * pitch.0, top + count.div_ceil(ABREAST) as f64 * pitch.1 + 16.0);
    let named = "each scene by itself; named are the points on the front";
    let mut svg = with_key(size, experiment, families, (rows, width, under), named);
    for (index, (title, (fronts, points))) in all.into_iter().enumerate() {
        let (across, up) = axes(families, UPWARDS[0].1);
        let axes = (
            if index + ABREAST >= count { across } else { String::new() },
            if index % ABREAST == 0 { up } else { String::new() },
        );
        let panel = Panel { title, axes, range, across: Across::Logarithmic, fronts, points, font: 11.0 };
        let (column, line) = ((index % ABREAST) as f64, (index / ABREAST) as f64);
        panel.draw(
            &mut svg,
            Rect { x: left + column * pitch.0, y: top + line * pitch.1, width: inside.0, height: inside.1 },
        );
    }
    Some(svg.finish())
}

/// The lines and points of all families, where `at` tells of them; all points named, or those on the front.
fn marks(
    families: &Families,
    at: impl Fn(&str) -> Option<(f64, f64)>,
    names_all: bool,
) -> Option<(Vec<Front>, Vec<Point>)> {
    let (mut fronts, mut points) = (Vec::new(), Vec::new());
    for ((_, builders), (shape, colour)) in families.lines.iter().zip(STYLES) {
        let known = builders.iter().filter_map(|(builder, label)| Some((at(builder)?, label)));
        let known: Vec<((f64, f64), &String)> = known.collect();
        let through = known.iter().map(|(at, _)| *at).collect();
        fronts.push(Front { through, line: Line { colour, width: 1.2, more: DASHES } });
        points.extend(known.into_iter().map(|(at, label)| Point {
            at,
            shape,
            colour,
            is_hollow: false,
            label: Some(label.clone()),
            interval: None,
        }));
    }
    let places: Vec<(f64, f64)> = points.iter().map(|point| point.at).collect();
    let on_front = front(&places);
    fronts.insert(0, Front { through: on_front.iter().map(|&i| places[i]).collect(), line: BAND });
    for (index, point) in points.iter_mut().enumerate() {
        point.label = point.label.take().filter(|_| names_all || on_front.contains(&index));
    }
    (!points.is_empty()).then_some((fronts, points))
}

fn axes(families: &Families, up: &str) -> (String, String) {
    let base = &families.base;
    (format!("build time / {base}"), format!("{up} / {base}"))
}

fn with_key(
    size: (f64, f64),
    experiment: &Experiment,
    families: &Families,
    (rows, width, under): (&[Row], u32, &Under),
    means: &str,
) -> Svg {
    let threads = rows.first().map_or(0, |row| row.threads);
    let about =
        format!("{means}; {width}-wide trees, {threads} threads, both axes logarithmic; band: the front");
    let traces = format!("traces: {}; steps: nodes visited and leaf blocks tested", under.about());
    let mut svg = sheet(size, experiment.about, &[&about, &traces]);
    let mut x = 26.0;
    for ((name, _), (shape, colour)) in families.lines.iter().zip(STYLES) {
        svg.line(&[(x - 4.0, 90.0), (x + 18.0, 90.0)], colour, 1.2, DASHES);
        svg.point((x + 7.0, 90.0), shape, 4.7, colour, false);
        svg.text((x + 24.0, 94.5), Anchor::Start, SMALL, INK, name, "");
        x += 46.0 + text_width(name, SMALL);
    }
    svg
}
