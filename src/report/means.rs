//! Means over scenes of the ratios to Embree SAH, with the scene where a tree does worst.

use super::grid::Grid;
use super::ratios::{SceneRows, kernels, trees};
use super::table::{kernel_heading, scenes};
use crate::bench::records::Row;
use crate::bench::statistics::{arithmetic_mean, geometric_mean};

/// The table of means.
pub fn means(rows: &[Row]) -> String {
    let names = scenes(rows);
    let by_scene: Vec<SceneRows<'_>> = names.iter().map(|scene| SceneRows::of(rows, scene)).collect();
    let kernels = kernels(rows);
    let mut header: Vec<String> =
        ["builder / width", "scenes", "build", "arith.", "worst", "cost"].map(Into::into).into();
    for kernel in &kernels {
        header.extend([format!("{} time", kernel_heading(*kernel)), "arith.".into(), "worst".into()]);
    }
    let mut grid = Grid::new(header);
    for (builder, width) in trees(rows) {
        let tree = (builder.as_str(), width);
        let over = |figure: &dyn Fn(&SceneRows<'_>) -> Option<f64>| -> Vec<(f64, &str)> {
            let figures = by_scene.iter().zip(&names);
            figures.filter_map(|(scene, name)| Some((figure(scene)?, name.as_str()))).collect()
        };
        let builds = over(&|scene| scene.build_ratio(tree).map(|ratio| ratio.value));
        if builds.is_empty() {
            continue;
        }
        let [geometric, arithmetic, worst] = mean_cells(&builds);
        let costs = over(&|scene| scene.sah_ratio(tree));
        let mut cells = vec![format!("{builder} / {width}"), builds.len().to_string()];
        cells.extend([geometric, arithmetic, worst, mean_cells(&costs)[0].clone()]);
        for &kernel in &kernels {
            cells.extend(mean_cells(&over(&|scene| scene.trace_ratio(tree, kernel).map(|r| r.value))));
        }
        grid.push(cells);
    }
    if grid.is_empty() {
        return String::new();
    }
    format!(
        "## Means of the ratios to Embree SAH, width 4 (geometric; arith.: arithmetic, as in the paper)\n\n{}",
        grid.markdown()
    )
}

/// Geometric mean, arithmetic mean, and the largest with its scene.
fn mean_cells(figures: &[(f64, &str)]) -> [String; 3] {
    let values: Vec<f64> = figures.iter().map(|figure| figure.0).collect();
    let show = |mean: Option<f64>| mean.map_or_else(String::new, |mean| format!("{mean:.3}"));
    let worst = figures.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let worst = worst.map_or_else(String::new, |(value, name)| format!("{value:.2} {name}"));
    [show(geometric_mean(&values)), show(arithmetic_mean(&values)), worst]
}
