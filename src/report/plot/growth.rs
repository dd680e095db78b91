//! The figure of growth: nanoseconds per triangle against triangles, a line for each builder.

use super::chart::{Across, DASHES, Front, Line, Panel, Point, Range, sheet};
use super::families::style;
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
    for (place, line) in growth.lines.iter().enumerate() {
        let (shape, colour) = style(&line.builder);
        // A second builder of a family is told from the first by hollow points and a broken line.
        let is_hollow = growth.lines[..place].iter().any(|other| style(&other.builder) == (shape, colour));
        // Beside those of other builders, so that intervals do not hide each other.
        let shift = 1.03f64.powf(place as f64 - 0.5 * (growth.lines.len() - 1) as f64);
        let at = growth.sizes.iter().zip(&line.ns).zip(&line.errors);
        let at = at.filter_map(|((&size, ns), &error)| {
            // A time of zero has no place on a logarithmic axis.
            let ns = ns.value().filter(|ns| *ns > 0.0 && ns.is_finite())?;
            Some(((size as f64 * 1e-6 * shift, ns), error))
        });
        let at: Vec<((f64, f64), f64)> = at.collect();
        let last = at.len().saturating_sub(1);
        points.extend(at.iter().enumerate().map(|(index, &((size, ns), error))| {
            let label = (index == last).then(|| line.builder.clone());
            // Half of the interval may be more than the time itself.
            let ends = (ns * (1.0 - error).max(0.2), ns * (1.0 + error));
            let interval = error.is_finite().then_some([(size, size), ends]);
            Point { at: (size, ns), shape, colour, is_hollow, label, interval }
        }));
        let through = at.into_iter().map(|(at, _)| at).collect();
        let more = if is_hollow { DASHES } else { "" };
        fronts.push(Front { through, line: Line { colour, width: 1.5, more } });
    }
    let first = points.first()?.at;
    let mut range = Range::from(first, &points);
    // Room for the labels, right of the last points.
    range.x.1 *= (range.x.1 / range.x.0).powf(0.17);
    let panel = Panel {
        title: String::new(),
        axes: ("million triangles".into(), "build time, ns per triangle".into()),
        range,
        across: Across::Logarithmic,
        fronts,
        points,
        font: 13.0,
    };
    let about = format!(
        "scalable scenes, 4-wide trees, {} threads, medians with their 95 % intervals over rounds, side by side; both axes logarithmic",
        growth.threads
    );
    let mut svg = sheet((820.0, 560.0), "Build time per triangle as scenes grow", &[&about]);
    panel.draw(&mut svg, Rect { x: 78.0, y: 76.0, width: 716.0, height: 416.0 });
    Some(svg.finish())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::scalable_name;

    #[test]
    fn a_time_of_zero_has_no_point() {
        let row = |builder: &str, triangles: u64, ms: f64| Row {
            scene: scalable_name(triangles as usize),
            triangles,
            ..Row::by_hand(builder, 4, "phr", ms, 1.0)
        };
        let rows = [
            row("lbvh", 10_000, 1.0),
            row("lbvh", 100_000, 0.0),
            row("phr-hq", 10_000, 5.0),
            row("phr-hq", 100_000, 60.0),
        ];
        let svg = growth(&rows).unwrap();
        assert!(svg.contains(">lbvh<") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
