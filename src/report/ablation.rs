//! What a part of a builder is worth: builders relative to one of them, scene by scene and in the mean.

use super::figures::{Figure, GRAFTED, PHR, SceneFigures, Tree, Under, WIDTH, scenes, tree_name, trees};
use super::grid::Grid;
use super::means::Ratios;
use crate::bench::records::Row;

/// The columns: what is compared, and under which kernel.
fn columns() -> [(&'static str, Figure, Under); 5] {
    let (grafted, phr) = (Under::One(GRAFTED.into()), Under::One(PHR.into()));
    [
        ("build", Figure::Build, grafted.clone()),
        ("SAH cost", Figure::Cost, grafted.clone()),
        ("EPO", Figure::Overlap, grafted.clone()),
        ("trace", Figure::Trace, grafted),
        ("trace, phr", Figure::Trace, phr),
    ]
}

/// The 4-wide trees of the builders `names` relative to those of `base`: the geometric means, then every scene.
///
/// # Errors
/// One line, if the rows have no such builder.
pub fn ablation(rows: &[Row], base: &str, names: &[&str]) -> Result<String, String> {
    let known: Vec<Tree<'_>> = trees(rows).into_iter().filter(|tree| tree.1 == WIDTH).collect();
    if let Some(unknown) = [base].iter().chain(names).find(|name| !known.contains(&(**name, WIDTH))) {
        let known: Vec<String> = known.into_iter().map(tree_name).collect();
        return Err(format!("the rows have no builder {unknown}; there are {}", known.join(", ")));
    }
    let columns = columns();
    let header = |first: &str| {
        let header = [first.to_owned(), "scene".into()].into_iter();
        header.chain(columns.iter().map(|column| column.0.to_owned()))
    };
    let (mut means, mut each) = (Grid::new(header("mean")), Grid::new(header("builder")));
    for &name in names {
        let line = |scene: String, ratio: &dyn Fn(Figure, &Under) -> Option<f64>| {
            let show = |ratio: Option<f64>| ratio.map_or_else(|| "-".into(), |ratio| format!("{ratio:.3}"));
            let ratios = columns.iter().map(|(_, figure, under)| show(ratio(*figure, under)));
            [name.to_owned(), scene].into_iter().chain(ratios).collect::<Vec<_>>()
        };
        let (base, tree) = ((base, WIDTH), (name, WIDTH));
        means.push(line(String::new(), &|figure, under| {
            Ratios::to(base, rows, tree, figure, under).geometric()
        }));
        for scene in scenes(rows) {
            let figures = SceneFigures::of(rows, &scene);
            each.push(line(scene, &|figure, under| Some(figures.ratio_to(base, tree, figure, under)?.value)));
        }
    }
    Ok(format!(
        "{}\n{}\nRelative to {base}; means are geometric, over {} scenes or those that have the figure. trace: all \
         recorded rays under embree-grafted, and beside it under phr.\n",
        means.markdown(),
        each.markdown(),
        scenes(rows).len()
    ))
}
