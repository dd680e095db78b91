//! Draws cut sizes: a panel per scene, a line per builder.

use super::BUILDERS;
use super::records::CutSizeRow;
use crate::report::figures::scenes_of;
use crate::report::plot::chart::{Across, Front, INK, Line, Panel, Point, Range, SMALL, sheet};
use crate::report::plot::labels::Rect;
use crate::report::plot::raster::text_width;
use crate::report::plot::svg::{Anchor, Shape};

/// Panels side by side.
const ABREAST: usize = 3;

/// The line of a builder: colours after Okabe and Ito, and dashes for those who tell no colours apart.
fn line(builder: &str) -> Line {
    const DASHED: &str = " stroke-dasharray=\"7 4\"";
    const DOTTED: &str = " stroke-dasharray=\"2 3\"";
    const MIXED: &str = " stroke-dasharray=\"9 3 2 3\"";
    let (colour, width, more) = match builder {
        "phr-fast" => ("#d55e00", 2.0, ""),
        // Wider, as that of phr-fast may run over it.
        "phr-hq" => ("#0072b2", 4.0, ""),
        "hunt-50" => ("#009e73", 2.0, DASHED),
        "hunt-500" => ("#000000", 2.0, DASHED),
        "phr-speed" => ("#cc79a7", 2.0, MIXED),
        "phr-quality" => ("#56b4e9", 2.0, MIXED),
        _ => ("#7f7f7f", 2.0, DOTTED),
    };
    Line { colour, width, more }
}

/// The figure; `None` without rows.
pub fn draw(rows: &[CutSizeRow]) -> Option<String> {
    let scenes = scenes_of(rows.iter().map(|row| &row.scene));
    let deepest = rows.iter().map(|row| row.depth).max()?;
    let most = rows.iter().map(|row| row.mean_nodes).fold(1.0, f64::max);
    let abreast = scenes.len().min(ABREAST);
    let (inside, pitch, left, top) = ((520.0, 340.0), (590.0, 420.0), 76.0, 124.0);
    let lines = scenes.len().div_ceil(ABREAST);
    let size = (left + abreast.max(2) as f64 * pitch.0, top + lines as f64 * pitch.1 + 10.0);
    let about = "average number of nodes of the cuts that are split, by depth; those that an extension splits down to leaves \
                 at once are left out; first cuts of phr-fast and phr-hq have at most 2048 nodes";
    let mut svg = sheet(size, "Size of cuts by depth", &[about]);
    let mut x = 26.0;
    for builder in BUILDERS.into_iter().filter(|builder| rows.iter().any(|row| row.builder == *builder)) {
        let Line { colour, width, more } = line(builder);
        svg.line(&[(x, 78.0), (x + 34.0, 78.0)], colour, width, more);
        svg.text((x + 40.0, 82.5), Anchor::Start, SMALL, INK, builder, "");
        x += 62.0 + text_width(builder, SMALL);
    }
    let count = scenes.len();
    for (index, scene) in scenes.into_iter().enumerate() {
        let of_scene: Vec<&CutSizeRow> = rows.iter().filter(|row| row.scene == scene).collect();
        let (mut fronts, mut points) = (Vec::new(), Vec::new());
        // The first above the others.
        for builder in BUILDERS.into_iter().rev() {
            let of_builder = of_scene.iter().filter(|row| row.builder == builder);
            let through: Vec<(f64, f64)> =
                of_builder.map(|row| (f64::from(row.depth), row.mean_nodes)).collect();
            let line = line(builder);
            // A single level has no line.
            if let [at] = through[..] {
                points.push(Point {
                    at,
                    shape: Shape::Circle,
                    colour: line.colour,
                    is_hollow: false,
                    label: None,
                    interval: None,
                });
            }
            fronts.push(Front { through, line });
        }
        let thousands = (of_scene[0].triangles as f64 / 1000.0).round();
        let panel = Panel {
            title: format!("{scene}, {thousands} k triangles"),
            axes: (
                if index + ABREAST >= count { "depth: binary splits above".into() } else { String::new() },
                if index % ABREAST == 0 { "nodes of a cut".into() } else { String::new() },
            ),
            range: Range { x: (0.0, f64::from(deepest)), y: (1.8, 1.2 * most.max(4.0)) },
            across: Across::Linear,
            fronts,
            points,
            font: 12.0,
        };
        let (column, row) = ((index % ABREAST) as f64, (index / ABREAST) as f64);
        panel.draw(
            &mut svg,
            Rect { x: left + column * pitch.0, y: top + row * pitch.1, width: inside.0, height: inside.1 },
        );
    }
    Some(svg.finish())
}
