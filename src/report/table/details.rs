//! One scene in full: every tree of any width, builds in every regime, and traces under every kernel, with
//! intervals of the ratios.

use crate::bench::row::Row;
use crate::report::figures::interval::SceneRatio;
use crate::report::figures::{BASELINE, Figure, SceneFigures, Tree, Under, kernels, trees};
use crate::report::grid::{Grid, short};

/// One scene's table, under a heading. A scene among `rows` alone or with others gives the same.
pub fn scene(rows: &[Row], scene: &str) -> String {
    let of_scene = SceneFigures::of(rows, scene);
    let unders: Vec<(String, Under)> = kernels(of_scene.totals().iter().copied())
        .into_iter()
        .map(|kernel| {
            let under = under(&of_scene, &kernel);
            (kernel, under)
        })
        .collect();
    let mut header: Vec<String> =
        ["builder / width", "build ms", "/SAH", "rebuild", "first", "cost", "/SAH", "EPO"]
            .map(Into::into)
            .into();
    for (kernel, _) in &unders {
        let kernel = kernel.trim_start_matches("embree-");
        header.extend([format!("{kernel} ms"), "MRays/s".into(), "/SAH".into()]);
    }
    let mut grid = Grid::new(header);
    for tree in trees(of_scene.totals().iter().copied()) {
        grid.push(line(&of_scene, tree, &unders));
    }
    let rays = of_scene.totals().iter().filter_map(|row| row.rays).max();
    let rays = rays.map_or_else(String::new, |rays| format!(", {} rays", grouped(rays)));
    format!("## {scene}: {} triangles{rays}\n\n{}", grouped(of_scene.triangles()), grid.markdown())
}

fn line(of_scene: &SceneFigures<'_>, tree: Tree<'_>, unders: &[(String, Under)]) -> Vec<String> {
    let build = of_scene.build(tree);
    let of_build =
        |figure: fn(&Row) -> Option<f64>| build.value().and_then(figure).map_or_else(String::new, short);
    let ratio = |figure, under: &Under| match of_scene.ratio(tree, figure, under) {
        Some(_) if tree == BASELINE => "1".into(),
        Some(ratio) => interval(&ratio),
        None => String::new(),
    };
    let ms = |row: Option<&Row>| row.and_then(|row| row.build_ms_median).map_or_else(String::new, short);
    let cost = of_scene.ratio(tree, Figure::Cost, &Under::Own);
    let mut cells = vec![
        format!("{} / {}", tree.0, tree.1),
        build.and_then(|row| row.build_ms_median).cell(short),
        ratio(Figure::Build, &Under::Own),
        ms(of_scene.rebuild(tree)),
        ms(of_scene.first(tree)),
        of_build(|row| row.sah),
        cost.map_or_else(String::new, |ratio| format!("{:.2}", ratio.value)),
        of_build(|row| row.epo),
    ];
    for (kernel, under) in unders {
        let row = of_scene.trace(tree, kernel);
        let filled = |figure: fn(&Row) -> Option<f64>| match row.and_then(figure).cell(short) {
            nothing if nothing == "-" => String::new(),
            shown => shown,
        };
        cells.extend([filled(|row| row.trace_ms_median), filled(|row| row.mrays_s)]);
        cells.push(row.value().map_or_else(String::new, |_| ratio(Figure::Trace, under)));
    }
    cells
}

/// What a kernel's times are relative to: Embree SAH under the same kernel, or under its own where it could
/// not be had under that. The legend tells of it.
fn under(of_scene: &SceneFigures<'_>, kernel: &str) -> Under {
    match of_scene.trace(BASELINE, kernel).value() {
        Some(_) => Under::One(kernel.into()),
        None => Under::Own,
    }
}

/// True if some scene's traces of ours can only be set beside Embree SAH under its own kernel.
pub fn kernels_are_mixed(rows: &[Row], scenes: &[String]) -> bool {
    scenes.iter().any(|scene| {
        let of_scene = SceneFigures::of(rows, scene);
        kernels(of_scene.totals().iter().copied()).iter().any(|kernel| under(&of_scene, kernel) == Under::Own)
    })
}

/// A ratio with the half width of its interval, where that is known.
pub(super) fn interval(ratio: &SceneRatio) -> String {
    let half = ratio.interval().half_width(ratio.value);
    // An interval wider than the ratio says no more than that nothing is known.
    if half < 1.0 {
        format!("{:.2} ±{:.2}", ratio.value, half * ratio.value)
    } else {
        format!("{:.2} ±?", ratio.value)
    }
}

/// Digits in groups of three.
pub(super) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|group| std::str::from_utf8(group).unwrap_or("")).collect();
    groups.join(" ")
}
