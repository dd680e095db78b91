//! The figure of growth: nanoseconds per triangle against triangles, a line for each builder.

use super::chart::{Across, Front, Line, Panel, Point, Range, sheet, style};
use super::labels::Rect;
use crate::bench::row::Row;
use crate::report::targets::growth::Growth;

/// The figure; `None` unless there are two sizes of the scalable scene.
pub fn growth(rows: &[Row]) -> Option<String> {
    let growth = Growth::of(rows);
    if growth.sizes.len() < 2 {
        return None;
    }
    let (mut fronts, mut points) = (Vec::new(), Vec::new());
    for line in &growth.lines {
        let (shape, colour) = style(&line.builder);
        let at = growth.sizes.iter().zip(&line.ns);
        let through: Vec<(f64, f64)> =
            at.filter_map(|(&size, ns)| Some((size as f64 * 1e-6, ns.value()?))).collect();
        let last = through.len().saturating_sub(1);
        points.extend(through.iter().enumerate().map(|(index, &at)| {
            let label = (index == last).then(|| line.builder.clone());
            Point { at, shape, colour, is_hollow: false, label, interval: None }
        }));
        fronts.push(Front { through, line: Line { colour, width: 1.5, more: "" } });
    }
    let first = points.first()?.at;
    let mut range = Range::from(first, &points);
    // Room for the labels, right of the last points.
    range.x.1 *= (range.x.1 / range.x.0).powf(0.25);
    let panel = Panel {
        title: String::new(),
        axes: ("million triangles".into(), "build time, ns per triangle".into()),
        range,
        across: Across::Logarithmic,
        fronts,
        points,
        font: 13.0,
    };
    let about = format!("scalable scenes, 4-wide trees, {} threads, both axes logarithmic", growth.threads);
    let mut svg = sheet((820.0, 560.0), "Build time per triangle as scenes grow", &[&about]);
    panel.draw(&mut svg, Rect { x: 78.0, y: 76.0, width: 716.0, height: 416.0 });
    Some(svg.finish())
}
