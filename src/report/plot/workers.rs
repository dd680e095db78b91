//! The figure of scaling: how many times as fast builds are on more workers, by the schedule of their timed tasks, a
//! line for each builder, and as measured where the machine has as many threads.

use super::chart::{Across, DASHES, Front, GREY, INK, Line, Panel, Point, Range, SMALL, sheet};
use super::key::in_lines;
use super::labels::Rect;
use super::raster::text_width;
use super::svg::{Anchor, Shape};
use crate::bench::scaling::row::ScalingRow;
use crate::bench::statistics::geometric_mean;
use crate::report::figures::{scenes_of, tree_name};
use crate::report::scaling::{measured, numbers, scheduled, trees};

/// Shapes and colours of the builders, after Okabe and Ito: most are of one family.
const STYLES: [(Shape, &str); 8] = [
    (Shape::Down, "#000000"),
    (Shape::Up, "#d55e00"),
    (Shape::Square, "#009e73"),
    (Shape::Circle, "#e69f00"),
    (Shape::Diamond, "#cc79a7"),
    (Shape::Up, "#0072b2"),
    (Shape::Square, "#56b4e9"),
    (Shape::Circle, "#7f7f7f"),
];

/// The mark of a builder by its place among them: beyond the colours, the shapes move on.
fn style(place: usize) -> (Shape, &'static str) {
    let at = |place: usize| STYLES[place % STYLES.len()];
    (at(place + place / STYLES.len()).0, at(place).1)
}

/// Width of the sheet.
const WIDTH: f64 = 900.0;

/// The figure; `None` unless builds were scheduled on two numbers of workers.
pub fn workers(rows: &[ScalingRow]) -> Option<String> {
    let counts = numbers(rows.iter());
    let (&least, &most) = (counts.first()?, counts.last().filter(|_| counts.len() > 1)?);
    let ideal = [least, most].map(|count| (f64::from(count), f64::from(count))).to_vec();
    let mut fronts = vec![Front { through: ideal, line: Line { colour: GREY, width: 1.2, more: DASHES } }];
    let (mut points, mut entries) = (Vec::new(), Vec::new());
    for (tree, (shape, colour)) in trees(rows.iter()).into_iter().zip((0..).map(style)) {
        let of_tree: Vec<&ScalingRow> =
            rows.iter().filter(|row| (&*row.builder, row.width) == tree).collect();
        let mean = |ratios: &dyn Fn(&[&ScalingRow], u32) -> Vec<f64>| -> Vec<(f64, f64)> {
            let at = |&count: &u32| Some((f64::from(count), geometric_mean(&ratios(&of_tree, count))?));
            counts.iter().filter_map(at).collect()
        };
        let point = |at, is_hollow| Point { at, shape, colour, is_hollow, label: None, interval: None };
        let through = mean(&scheduled);
        points.extend(through.iter().map(|&at| point(at, false)));
        // They are relative to the least, which is to be one.
        let above_one = mean(&measured).into_iter().filter(|at| least == 1 && at.0 > 1.0);
        points.extend(above_one.map(|at| point(at, true)));
        entries.push((tree_name(tree), shape, colour));
        fronts.push(Front { through, line: Line { colour, width: 1.5, more: "" } });
    }
    let range = Range::from((f64::from(most), f64::from(most)), &points);
    let panel = Panel {
        title: String::new(),
        axes: ("workers".into(), "times as fast as one worker".into()),
        range,
        across: Across::Logarithmic,
        fronts,
        points,
        font: 13.0,
    };
    let count = scenes_of(rows.iter().map(|row| &row.scene)).len();
    let about = format!(
        "an upper bound: the work of all timed tasks by the length of their schedule; geometric means over scenes ({count}), \
         medians of {} builds",
        rows[0].rounds
    );
    let hollow = "hollow: measured on as many threads of this machine, relative to one; broken: as many times as there are workers";
    let widths = entries.iter().map(|(name, ..)| 32.0 + text_width(name, SMALL));
    let places = in_lines(widths, (26.0, 92.0), WIDTH, 20.0);
    let top = places.last().map_or(0.0, |(_, y)| *y) + 28.0;
    let area = Rect { x: 78.0, y: top, width: WIDTH - 104.0, height: 436.0 };
    let mut svg = sheet((WIDTH, top + 504.0), "Speed of builds on more workers", &[&about, hollow]);
    for ((name, shape, colour), (x, y)) in entries.iter().zip(places) {
        svg.point((x, y), *shape, 4.7, colour, false);
        svg.text((x + 11.0, y + 4.5), Anchor::Start, SMALL, INK, name, "");
    }
    panel.draw(&mut svg, area);
    Some(svg.finish())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::scaling::row::ALL;

    fn row(builder: &str, workers: u32, scheduled_ms: f64, measured_ms: Option<f64>) -> ScalingRow {
        ScalingRow {
            scene: "a".into(),
            builder: builder.into(),
            width: 8,
            workers,
            phase: ALL.into(),
            rounds: 3,
            work_ms: 8.0,
            scheduled_ms,
            measured_ms,
            ..ScalingRow::default()
        }
    }

    #[test]
    fn every_builder_has_a_line_and_what_was_measured_a_hollow_point() {
        let rows = [
            row("lbvh", 1, 8.0, Some(9.0)),
            row("lbvh", 2, 4.5, Some(6.0)),
            row("lbvh", 16, 1.0, None),
            row("phr-hq", 1, 8.0, None),
            row("phr-hq", 16, 0.0, None),
        ];
        let svg = workers(&rows).unwrap();
        assert!(svg.contains(">lbvh / 8<") && svg.contains(">phr-hq / 8<") && !svg.contains("inf"), "{svg}");
        // Measured on two threads; a schedule of no length has no place.
        assert_eq!(svg.matches("fill-opacity").count(), 1, "{svg}");
        assert!(workers(&rows[..1]).is_none() && workers(&[]).is_none());
    }
}
