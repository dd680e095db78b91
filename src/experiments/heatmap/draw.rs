//! Draws a heat map. The colours are Viridis (Smith and van der Walt, Matplotlib 2.0, as in the crate colorous):
//! perceptually uniform, and in order for colour-blind readers and on grey paper too.

use super::records::Panel;
use crate::report::figures::tree_name;
use crate::report::grid::short;
use crate::report::plot::chart::{INK, SMALL, sheet};
use crate::report::plot::raster::{Patch, RasterError, png_with};
use crate::report::plot::svg::Anchor;

/// Panels side by side at most.
const ABREAST: usize = 4;
/// About the least extent of a panel, pixels; smaller ones are enlarged.
const LEAST: usize = 400;
/// The least width of the picture: its heading must fit.
const LEAST_WIDTH: usize = 760;
/// Room left of the first panel and between two.
const GAP: usize = 24;
const TOP: usize = 76;
/// Title above a panel, texts below it.
const TITLE: usize = 26;
const BELOW: usize = 64;
/// Height of the colour bar.
const BAR: usize = 18;

/// The heat map of `panels` as PNG; all have the size and the scale of the first.
///
/// # Errors
/// A picture too large for memory.
pub fn draw(panels: &[Panel]) -> Result<Vec<u8>, RasterError> {
    let Some(first) = panels.first().map(|panel| &panel.row) else {
        return Err(RasterError::Size { width: 0, height: 0 });
    };
    let size = first.size as usize;
    let enlarged = ((LEAST + size / 2) / size).max(1);
    let side = size * enlarged;
    let abreast = panels.len().min(ABREAST);
    let lines = panels.len().div_ceil(ABREAST);
    let width = (GAP + abreast * (side + GAP)).max(LEAST_WIDTH);
    let bar_top = TOP + lines * (TITLE + side + BELOW);
    let title = format!("Traversal steps of primary rays: {}, view {}", first.scene, first.view);
    let about = format!(
        "nodes visited and leaf blocks tested per pixel, {} x {} pixels, {} threads, our kernel for all trees",
        size, size, first.threads
    );
    let mut svg = sheet((width as f64, (bar_top + BAR + 44) as f64), &title, &[&about]);
    let mut patches = Vec::new();
    for (index, Panel { row, steps }) in panels.iter().enumerate() {
        let (x, y) = (GAP + index % ABREAST * (side + GAP), TOP + index / ABREAST * (TITLE + side + BELOW));
        let name = tree_name((&row.builder, row.width));
        let mut text = |down: usize, size: f64, text: &str, more: &str| {
            svg.text((x as f64, (y + down) as f64), Anchor::Start, size, INK, text, more);
        };
        text(TITLE - 8, 16.0, &name, " font-weight=\"bold\"");
        text(TITLE + side + 20, 15.0, &format!("build {} ms", short(row.build_ms)), "");
        let counts = format!(
            "steps: mean {}, 95 % at most {}, most {}",
            short(row.steps_mean),
            row.steps_p95,
            row.steps_max
        );
        text(TITLE + side + 40, 15.0, &counts, "");
        let enlarge =
            |i: usize| colour(f64::from(steps[i / side / enlarged * size + i % side / enlarged]), row.scale);
        patches.push(Patch { at: (x, y + TITLE), width: side, rgb: (0..side * side).map(enlarge).collect() });
    }
    // The other half has room for words.
    let bar = width / 2 - GAP;
    let along: Vec<[u8; 3]> =
        (0..bar).map(|i| colour(i as f64 / (bar - 1) as f64 * f64::from(first.scale), first.scale)).collect();
    patches.push(Patch { at: (GAP, bar_top), width: bar, rgb: along.repeat(BAR) });
    for tick in 0..=4 {
        let steps = f64::from(first.scale) * f64::from(tick) / 4.0;
        let x = GAP as f64 + (bar - 1) as f64 * f64::from(tick) / 4.0;
        svg.line(&[(x, (bar_top + BAR) as f64), (x, (bar_top + BAR + 5) as f64)], INK, 1.0, "");
        svg.text((x, (bar_top + BAR + 20) as f64), Anchor::Middle, SMALL, INK, &steps.to_string(), "");
    }
    let beside = ((GAP + bar + 14) as f64, (bar_top + BAR - 4) as f64);
    let legend = format!("steps per ray; yellow: {} or more", first.scale);
    svg.text(beside, Anchor::Start, SMALL, INK, &legend, "");
    png_with(&svg.finish(), 1.0, &patches)
}

fn colour(steps: f64, scale: u32) -> [u8; 3] {
    let colorous::Color { r, g, b } = colorous::VIRIDIS.eval_continuous((steps / f64::from(scale)).min(1.0));
    [r, g, b]
}

#[cfg(test)]
mod tests {
    use super::super::records::HeatmapRow;
    use super::*;

    #[test]
    fn a_heat_map_is_the_same_every_time_and_tells_its_counts_apart() {
        let panel = |builder: &str, most: u16| {
            let row = HeatmapRow {
                git_rev: "1234".into(),
                cpu: "a".into(),
                scene: "s".into(),
                triangles: 10,
                view: 0,
                size: 8,
                builder: builder.into(),
                width: 4,
                threads: 2,
                build_ms: 1.25,
                steps_mean: 3.5,
                steps_p95: 9,
                steps_p99: 10,
                steps_max: most.into(),
                scale: 10,
            };
            Panel { row, steps: (0..64).map(|i| i % most).collect() }
        };
        let drawn = draw(&[panel("a", 5), panel("b", 10)]).unwrap();
        assert_eq!(drawn, draw(&[panel("a", 5), panel("b", 10)]).unwrap());
        assert_ne!(drawn, draw(&[panel("a", 6), panel("b", 10)]).unwrap());
        assert!(draw(&[]).is_err());
        let ends = [0.0, 10.0, 11.0].map(|steps| colour(steps, 10));
        assert!(ends[0] != ends[1] && ends[1] == ends[2]);
    }
}
