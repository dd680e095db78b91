//! The figure of threads: how many times as fast builds are on several threads as on one, a line for each tree.

use super::chart::{GREY, INK, SMALL, sheet};
use super::raster::text_width;
use super::svg::{Anchor, Shape};
use super::ticks::ticks;
use crate::bench::row::Row;
use crate::report::evidence::speedups::{Mean, Speedup, means, speedups};
use crate::report::figures::interval::Interval;
use crate::report::figures::{Tree, scenes, tree_name, trees};

const LENGTH: f64 = 620.0;
const LINE: f64 = 30.0;
const TOP: f64 = 84.0;
const COLOUR: &str = "#0072b2";

/// The figure; `None` unless some builds were timed on one thread and on several.
pub fn threads(rows: &[Row]) -> Option<String> {
    let of_tree = |tree| (tree, speedups(rows, tree));
    let lines: Vec<(Tree<'_>, Vec<Speedup>)> =
        trees(rows).into_iter().map(of_tree).filter(|(_, speedups)| !speedups.is_empty()).collect();
    let all = || lines.iter().flat_map(|(_, speedups)| speedups);
    let mut counts: Vec<u32> = all().map(|speedup| speedup.threads).collect();
    counts.sort_unstable();
    counts.dedup();
    let most_threads = *counts.last()?;
    let means: Vec<Vec<Mean>> = lines.iter().map(|(_, speedups)| means(speedups, &counts)).collect();
    let left = 34.0 + lines.iter().map(|(tree, _)| text_width(&tree_name(*tree), SMALL)).fold(0.0, f64::max);
    let bottom = TOP + lines.len() as f64 * LINE;
    let intervals = || means.iter().flatten().filter_map(|mean| mean.interval);
    let ends = intervals().flat_map(|interval| [interval.low, interval.high]);
    let values: Vec<f64> = all().map(|speedup| speedup.ratio.value).chain(ends).collect();
    let (least, most) = values
        .into_iter()
        .fold((1.0_f64, f64::from(most_threads)), |(least, most), value| (least.min(value), most.max(value)));
    let (least, most) = (0.97 * least, 1.03 * most);
    let told: Vec<String> = counts.iter().map(ToString::to_string).collect();
    let with = if intervals().next().is_some() { " with its 95 % interval" } else { "" };
    let about = format!(
        "fresh builds on {} threads, {} scenes (grey, on {most_threads}) and their geometric mean{with} (blue), logarithmic",
        told.join(", "),
        scenes(rows).len()
    );
    let title = "Speed of builds on several threads relative to one";
    let mut svg = sheet((left + LENGTH + 40.0, bottom + 56.0), title, &[&about]);
    let x = |value: f64| left + LENGTH * (value / least).ln() / (most / least).ln();
    for (tick, text) in ticks((least, most), 12) {
        svg.line(&[(x(tick), TOP), (x(tick), bottom)], "#e6e6e6", 1.0, "");
        svg.text((x(tick), bottom + 18.0), Anchor::Middle, SMALL, INK, &text, "");
    }
    svg.text(
        (left + 0.5 * LENGTH, bottom + 40.0),
        Anchor::Middle,
        SMALL,
        INK,
        "times as fast as on one thread",
        "",
    );
    svg.frame((left, TOP), (LENGTH, bottom - TOP), "#b3b3b3");
    for (line, ((tree, speedups), means)) in lines.iter().zip(&means).enumerate() {
        let y = TOP + (line as f64 + 0.5) * LINE;
        svg.text((left - 10.0, y + 4.5), Anchor::End, SMALL, INK, &tree_name(*tree), "");
        for speedup in speedups.iter().filter(|speedup| speedup.threads == most_threads) {
            svg.point((x(speedup.ratio.value), y + 6.0), Shape::Circle, 2.4, GREY, true);
        }
        for Mean { value, interval } in means {
            if let Some(Interval { low, high }) = interval {
                svg.line(&[(x(*low), y - 4.0), (x(*high), y - 4.0)], COLOUR, 2.5, "");
            }
            svg.point((x(*value), y - 4.0), Shape::Diamond, 4.6, COLOUR, false);
        }
    }
    Some(svg.finish())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::evidence::speedups::tests::two_scenes;

    #[test]
    fn builds_on_one_thread_are_set_beside_those_on_more() {
        let row = |threads, ms| Row { threads, ..Row::by_hand("lbvh", 4, "none", ms, 1.0) };
        assert!(threads(&[row(2, 10.0)]).is_none());
        assert!(threads(&[row(1, 18.0), row(2, 0.0)]).is_none(), "a time of zero");
        let svg = threads(&[row(2, 10.0), row(1, 18.0), row(4, 6.0), row(4, 6.0)]).unwrap();
        assert!(svg.contains("on 2, 4 threads") && svg.contains(">lbvh<"), "{svg}");
    }

    #[test]
    fn means_are_drawn_with_their_intervals() {
        let svg = threads(&two_scenes()).unwrap();
        assert!(svg.contains("with its 95 % interval (blue)"), "{svg}");
        assert_eq!(svg.matches("stroke-width=\"2.5\"").count(), 1, "{svg}");
    }
}
