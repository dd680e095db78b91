//! Table 1 in the paper's own arrangement: methods in rows, scenes in columns, three scenes to a block; per
//! cell build time, SAH cost, time of a frame and million rays per second.

use crate::bench::row::Row;
use crate::report::figures::{Figure, Place, SceneFigures, Tree, Under, WIDTH, scenes, trees};
use crate::report::grid::{Grid, short};

/// Scenes side by side.
const ABREAST: usize = 3;

/// The table, with headings of its own and the cells that are missing named below; nothing without a 4-wide tree.
pub fn table1(rows: &[Row], under: &Under) -> String {
    let trees: Vec<Tree<'_>> = trees(rows).into_iter().filter(|tree| tree.1 == WIDTH).collect();
    if trees.is_empty() {
        return String::new();
    }
    let names = scenes(rows);
    let of_scenes: Vec<(&str, SceneFigures<'_>)> =
        names.iter().map(|name| (name.as_str(), SceneFigures::of(rows, name))).collect();
    let time = SceneFigures::traced_by(of_scenes.iter().map(|(_, scene)| scene), under);
    // A column means one thing: reduced rows do not tell of how many views they are the sums.
    let is_traced = |scene: &SceneFigures<'_>| scene.totals().iter().any(|row| row.trace_ms_median.is_some());
    let is_per_view = of_scenes.iter().all(|(_, scene)| scene.views.is_some() || !is_traced(scene));
    let mut text = format!("## Table 1: trees of width {WIDTH}\n\n");
    for block in of_scenes.chunks(ABREAST) {
        text += &(self::block(block, &trees, (time, is_per_view), under) + "\n");
    }
    let shown = match time {
        Figure::Frame => "frame ms: the whole path-traced frame",
        _ => "trace ms: the recorded rays alone, without shading (run with --frames for frames)",
    };
    let of = if is_per_view { "of one view, mean of the views" } else { "of all views together" };
    text += &format!("{shown} {of}; medians of rounds. Traces: {}.\n", under.about());
    text + &missing(&of_scenes, &trees, under)
}

fn block(
    block: &[(&str, SceneFigures<'_>)],
    trees: &[Tree<'_>],
    (time, is_per_view): (Figure, bool),
    under: &Under,
) -> String {
    let mut header = vec!["method".to_owned(), "kernel".into()];
    let mut units = vec![String::new(), String::new()];
    for (name, scene) in block {
        let thousands = (scene.triangles() as f64 / 1000.0).round();
        header.extend([(*name).to_owned(), format!("{thousands} k"), String::new(), String::new()]);
        let time = if time == Figure::Frame { "frame ms" } else { "trace ms" };
        units.extend(["build ms", "cost", time, "MRays/s"].map(Into::into));
    }
    let mut grid = Grid::new(header);
    grid.push(units);
    for &tree in trees {
        let kernel = under.kernel_of(tree.0);
        let mut cells = vec![tree.0.to_owned(), kernel.to_owned()];
        for (_, scene) in block {
            let figure = |figure| scene.figure(tree, figure, under);
            cells.push(figure(Figure::Build).cell(|build| short(build.median)));
            cells.push(figure(Figure::Cost).cell(|cost| short(cost.median)));
            let views = if is_per_view { scene.views.unwrap_or(1) } else { 1 };
            cells.push(figure(time).cell(|time| short(time.median / views as f64)));
            cells.push(scene.trace(tree, kernel).and_then(|row| row.mrays_s).cell(short));
        }
        grid.push(cells);
    }
    grid.markdown()
}

/// The cells without figures, by scene. Failures are told with the errors.
fn missing(of_scenes: &[(&str, SceneFigures<'_>)], trees: &[Tree<'_>], under: &Under) -> String {
    let mut text = String::new();
    for (name, scene) in of_scenes {
        let lacks = |figure| {
            let lacking = trees.iter().filter(|&&tree| scene.figure(tree, figure, under) == Place::Missing);
            lacking.map(|tree| tree.0).collect::<Vec<_>>()
        };
        for (what, lacking) in
            [("build", lacks(Figure::Build)), ("cost", lacks(Figure::Cost)), ("trace", lacks(Figure::Trace))]
        {
            if !lacking.is_empty() {
                text += &format!("\nNo {what} for {name}: {}", lacking.join(", "));
            }
        }
    }
    if text.is_empty() { text } else { text + "\n" }
}
