//! The figure of threads: how many times as fast builds are on several threads as on one, a line for each tree.

use super::chart::{GREY, INK, SMALL, sheet};
use super::raster::text_width;
use super::svg::{Anchor, Shape};
use super::ticks::ticks;
use crate::bench::row::Row;
use crate::bench::statistics::geometric_mean;
use crate::report::figures::{Tree, scenes, tree_name, trees};

const LENGTH: f64 = 620.0;
const LINE: f64 = 30.0;
const TOP: f64 = 84.0;
const COLOUR: &str = "#0072b2";

/// The speedup of a tree's builds in a scene.
struct Speedup {
    threads: u32,
    value: f64,
}

/// The figure; `None` unless some builds were timed on one thread and on several.
pub fn threads(rows: &[Row]) -> Option<String> {
    let of_tree = |tree| (tree, speedups(rows, tree));
    let lines: Vec<(Tree<'_>, Vec<Speedup>)> =
        trees(rows).into_iter().map(of_tree).filter(|(_, speedups)| !speedups.is_empty()).collect();
    let counts = {
        let mut counts: Vec<u32> =
            lines.iter().flat_map(|(_, speedups)| speedups).map(|speedup| speedup.threads).collect();
        counts.sort_unstable();
        counts.dedup();
        counts
    };
    let most_threads = *counts.last()?;
    let left = 34.0 + lines.iter().map(|(tree, _)| text_width(&tree_name(*tree), SMALL)).fold(0.0, f64::max);
    let bottom = TOP + lines.len() as f64 * LINE;
    let values = || lines.iter().flat_map(|(_, speedups)| speedups).map(|speedup| speedup.value);
    let (least, most) =
        (0.97 * values().fold(1.0, f64::min), 1.03 * values().fold(f64::from(most_threads), f64::max));
    let told: Vec<String> = counts.iter().map(ToString::to_string).collect();
    let about = format!(
        "fresh builds on {} threads, {} scenes (grey, on {most_threads}) and their geometric mean (blue), logarithmic",
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
    for (line, (tree, speedups)) in lines.iter().enumerate() {
        let y = TOP + (line as f64 + 0.5) * LINE;
        svg.text((left - 10.0, y + 4.5), Anchor::End, SMALL, INK, &tree_name(*tree), "");
        for speedup in speedups.iter().filter(|speedup| speedup.threads == most_threads) {
            svg.point((x(speedup.value), y + 6.0), Shape::Circle, 2.4, GREY, true);
        }
        for &count in &counts {
            let of_count = speedups.iter().filter(|speedup| speedup.threads == count);
            let values: Vec<f64> = of_count.map(|speedup| speedup.value).collect();
            if let Some(mean) = geometric_mean(&values) {
                svg.point((x(mean), y - 4.0), Shape::Diamond, 4.6, COLOUR, false);
            }
        }
    }
    Some(svg.finish())
}

/// The speedups of a tree, scene by scene, by more threads than one.
fn speedups(rows: &[Row], tree: Tree<'_>) -> Vec<Speedup> {
    let is_of_tree = |row: &&Row| {
        (row.builder.as_str(), row.width) == tree && row.is_total() && row.is_compared() && row.is_good()
    };
    let mut all = Vec::new();
    for scene in scenes(rows) {
        let of_scene = rows.iter().filter(is_of_tree).filter(|row| row.scene == scene);
        // A tree has a row for each kernel, all with the same builds.
        let mut times: Vec<(u32, f64)> =
            of_scene.filter_map(|row| Some((row.threads, row.build_ms_median?))).collect();
        times.sort_by_key(|(threads, _)| *threads);
        times.dedup_by_key(|(threads, _)| *threads);
        let Some(&(1, alone)) = times.first() else { continue };
        all.extend(times[1..].iter().map(|&(threads, ms)| Speedup { threads, value: alone / ms }));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn builds_on_one_thread_are_set_beside_those_on_more() {
        let row = |threads, ms| Row { threads, ..Row::by_hand("lbvh", 4, "none", ms, 1.0) };
        assert!(threads(&[row(2, 10.0)]).is_none());
        let rows = [row(2, 10.0), row(1, 18.0), row(4, 6.0), row(4, 6.0)];
        let told: Vec<(u32, f64)> =
            speedups(&rows, ("lbvh", 4)).iter().map(|speedup| (speedup.threads, speedup.value)).collect();
        assert_eq!(told, [(2, 1.8), (4, 3.0)]);
        let svg = threads(&rows).unwrap();
        assert!(svg.contains("on 2, 4 threads") && svg.contains(">lbvh<"), "{svg}");
    }
}
