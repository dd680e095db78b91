//! What the assertions in the distribution's Embree cost: the same runs with its library and with one of the same source
//! that has none (`make embree-ndebug`).

use crate::bench::row::Row;
use crate::bench::statistics::geometric_mean;
use crate::report::figures::{
    Figure, GRAFTED, NATIVE, PHR, SceneFigures, Tree, Under, scenes, tree_name, trees,
};
use crate::report::grid::Grid;
use crate::report::targets::judge::{Judge, Verdict};
use crate::report::targets::list::{Measure, targets};

/// Times without assertions relative to those with them, of builds and under each kernel: geometric means over the scenes
/// of both runs. Below, the targets of build times in `rows` that would be judged otherwise if Embree's time were
/// corrected by it.
pub fn assertions(rows: &[Row], with: &[Row], without: &[Row]) -> String {
    let kernels = [NATIVE, GRAFTED, PHR];
    let header = ["tree".to_owned(), "build".into()].into_iter().chain(kernels.map(str::to_owned));
    let mut grid = Grid::new(header);
    for tree in trees(with) {
        let figures = [(Figure::Build, Under::best(with))]
            .into_iter()
            .chain(kernels.map(|kernel| (Figure::Trace, Under::One(kernel.into()))));
        let cells = figures.map(|(figure, under)| {
            let change = change(with, without, tree, figure, &under);
            change.map_or_else(|| "-".into(), |change| format!("{change:.3}"))
        });
        grid.push([tree_name(tree)].into_iter().chain(cells).collect());
    }
    let noun = scenes(with).len();
    format!(
        "{}\nWithout assertions relative to with them: geometric means over {noun} scenes, {} threads. Our builders and the \
         kernel phr run the same code in both: what they show is noise.\n\n{}",
        grid.markdown(),
        with.first().map_or(0, |row| row.threads),
        claims(rows, with, without)
    )
}

/// A figure of `tree` without assertions, relative to that with them.
fn change(with: &[Row], without: &[Row], tree: Tree<'_>, figure: Figure, under: &Under) -> Option<f64> {
    let ratio = |scene: &String| {
        let of = |rows| Some(SceneFigures::of(rows, scene).figure(tree, figure, under).value()?.median);
        Some(of(without)? / of(with)?)
    };
    let ratios: Vec<f64> = scenes(with).iter().filter_map(ratio).collect();
    geometric_mean(&ratios)
}

/// The targets of build times that the correction decides.
fn claims(rows: &[Row], with: &[Row], without: &[Row]) -> String {
    let judge = Judge::new(rows);
    let mut grid = Grid::new(["builder", "build against", "target", "mean", "corrected", "", "corrected"]);
    for target in targets() {
        let (Measure::Build(base), Some(limit)) = (target.measure, target.mean) else { continue };
        let base = (base, target.width);
        let Some(change) = change(with, without, base, Figure::Build, &Under::Own) else { continue };
        let Some(mean) = judge.judge(&target).mean else { continue };
        let (now, corrected) = (Verdict::of(mean <= limit), Verdict::of(mean / change <= limit));
        if now != corrected {
            grid.push(vec![
                format!("{} / {}", target.builder, target.width),
                base.0.into(),
                format!("≤ {limit:.2}"),
                format!("{mean:.3}"),
                format!("{:.3}", mean / change),
                now.cell(),
                corrected.cell(),
            ]);
        }
    }
    if grid.is_empty() {
        return "No target of a build time is closer to its limit than that.\n".into();
    }
    format!("Targets of build times that are closer to their limit than that:\n\n{}", grid.markdown())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(builder: &str, build: f64) -> Row {
        Row { triangles: 200_000, ..Row::by_hand(builder, 4, GRAFTED, build, 1.0) }
    }

    #[test]
    fn a_target_closer_than_the_correction_is_named() {
        let of = |sah, ours| [row("embree-sah", sah), row("phr-hq", ours)];
        // 0.78 of Embree SAH's time; without assertions it takes 0.95 of its own.
        let text = assertions(&of(100.0, 78.0), &of(100.0, 78.0), &of(95.0, 78.0));
        let line = text.lines().find(|line| line.starts_with("| phr-hq") && line.contains("met")).unwrap();
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        assert_eq!(
            cells[1..8],
            ["phr-hq / 4", "embree-sah", "≤ 0.80", "0.780", "0.821", "met", "not met"],
            "{text}"
        );
        assert!(text.contains("| embree-sah | 0.950 |"), "{text}");
        let same = assertions(&of(100.0, 50.0), &of(100.0, 50.0), &of(95.0, 50.0));
        assert!(same.contains("No target of a build time"), "{same}");
    }
}
