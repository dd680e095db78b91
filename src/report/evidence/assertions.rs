//! What the assertions in the distribution's Embree cost: the same runs with its library and with one of the same
//! source that has none (`make bench-ndebug`).

use crate::bench::row::Row;
use crate::report::figures::interval::{Interval, Noise, Over, SceneRatio};
use crate::report::figures::{
    Figure, GRAFTED, NATIVE, PHR, SceneFigures, Tree, Under, scenes, tree_name, trees,
};
use crate::report::grid::Grid;
use crate::report::means::Ratios;
use crate::report::targets::judge::{Judge, Verdict};
use crate::report::targets::list::{Measure, targets};

/// Times without assertions relative to those with them, of builds and under each kernel: geometric means over the
/// scenes of both runs. Below, the targets of build times in `rows` that are closer to their limit than that, or
/// would be judged otherwise if Embree's time were corrected by it.
pub fn assertions(rows: &[Row], with: &[Row], without: &[Row]) -> String {
    let kernels = [NATIVE, GRAFTED, PHR];
    let header = ["tree".to_owned(), "build".into()].into_iter().chain(kernels.map(str::to_owned));
    let mut grid = Grid::new(header);
    for tree in trees(with) {
        let figures = [(Figure::Build, Under::best(with))]
            .into_iter()
            .chain(kernels.map(|kernel| (Figure::Trace, Under::One(kernel.into()))));
        let cells = figures.map(|(figure, under)| {
            let changes = changes(with, without, tree, figure, &under);
            let change = changes.geometric().zip(changes.interval(Over::ScenesAndRounds));
            change.map_or_else(|| "-".into(), |(mean, interval)| format!("{mean:.2} {}", interval.shown(2)))
        });
        grid.push([tree_name(tree)].into_iter().chain(cells).collect());
    }
    let noun = scenes(with).len();
    format!(
        "{}\nWithout assertions relative to with them: geometric means over {noun} scenes, {} threads, in brackets \
         95 % intervals over scenes and rounds. Our builders and the \
         kernel phr run the same code in both: what they show is noise.\n\n{}",
        grid.markdown(),
        with.first().map_or(0, |row| row.threads),
        claims(rows, with, without)
    )
}

/// A figure of `tree` without assertions, relative to that with them. Rounds of two runs are no pairs.
fn changes(with: &[Row], without: &[Row], tree: Tree<'_>, figure: Figure, under: &Under) -> Ratios {
    let ratio = |scene: &String| {
        let of = |rows| SceneFigures::of(rows, scene).figure(tree, figure, under).value();
        let (without, with) = (of(without)?, of(with)?);
        let noise = Noise::of(&without, &with, Vec::new());
        Some(SceneRatio { scene: scene.clone(), value: without.median / with.median, noise })
    };
    Ratios(scenes(with).iter().filter_map(ratio).collect())
}

/// The interval of the quotient of two means that err independently of each other, by the distances of their ends.
fn of_quotient((above, of_above): (f64, Interval), (below, of_below): (f64, Interval)) -> Interval {
    let down = (above / of_above.low).ln().hypot((of_below.high / below).ln());
    let up = (of_above.high / above).ln().hypot((below / of_below.low).ln());
    Interval { low: above / below * (-down).exp(), high: above / below * up.exp() }
}

/// The targets of build times whose means are closer to their limit than the correction, and those that it decides.
fn claims(rows: &[Row], with: &[Row], without: &[Row]) -> String {
    let judge = Judge::new(rows);
    let header =
        ["builder", "build against", "target", "mean", "95 %", "", "correction", "corrected", "95 %", ""];
    let mut grid = Grid::new(header);
    for target in targets() {
        let (Measure::Build(base), Some(limit)) = (target.measure, target.mean) else { continue };
        let base = (base, target.width);
        let changes = changes(with, without, base, Figure::Build, &Under::Own);
        let Some(change) = changes.geometric() else { continue };
        let of_change = changes.interval(Over::ScenesAndRounds).unwrap_or(Interval::UNKNOWN);
        let judged = judge.judge(&target);
        let Some((mean, interval)) = judged.mean.zip(judged.interval) else { continue };
        let by_correction = of_quotient((mean, interval), (change, of_change));
        let [now, corrected] = [interval, by_correction].map(|interval| Verdict::at_most(limit, interval));
        if (mean / limit).ln().abs() <= change.ln().abs() || now != corrected {
            grid.push(vec![
                tree_name((target.builder, target.width)),
                tree_name(base),
                format!("≤ {limit:.2}"),
                format!("{mean:.3}"),
                interval.shown(3),
                now.cell(),
                format!("{:+.1} %", 100.0 * (1.0 / change - 1.0)),
                format!("{:.3}", mean / change),
                by_correction.shown(3),
                corrected.cell(),
            ]);
        }
    }
    if grid.is_empty() {
        return "No target of a build time is closer to its limit than that, and none is judged otherwise by it.\n".into();
    }
    format!(
        "Targets of build times that the correction could decide, or that by the mean alone it does. Corrected intervals \
         hold what is not known of the correction:\n\n{}",
        grid.markdown()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(builder: &str, build: f64) -> Row {
        Row { triangles: 200_000, ..Row::by_hand(builder, 4, GRAFTED, build, 1.0) }
    }

    /// The same in two scenes, so that there is an interval.
    fn rows(sah: f64, ours: f64) -> Vec<Row> {
        let scene = |scene: &'static str| {
            [row("embree-sah", sah), row("phr-hq", ours)].map(|row| Row { scene: scene.into(), ..row })
        };
        ["a", "b"].into_iter().flat_map(scene).collect()
    }

    #[test]
    fn a_target_closer_than_the_correction_is_named() {
        // 0.78 of Embree SAH's time; without assertions it takes 0.95 of its own.
        let told = |ours| assertions(&rows(100.0, ours), &rows(100.0, ours), &rows(95.0, ours));
        let text = told(78.0);
        let line = |text: &str| {
            text.lines().find(|line| line.starts_with("| phr-hq") && line.contains("met")).map(|line| {
                line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>()[1..11].join("; ")
            })
        };
        assert_eq!(
            line(&text).unwrap(),
            "phr-hq; embree-sah; ≤ 0.80; 0.780; [0.780, 0.780]; met; +5.3 %; 0.821; [0.821, 0.821]; not met",
            "{text}"
        );
        // Missed by less than the correction, which makes it worse.
        assert!(line(&told(82.0)).unwrap().ends_with("not met; +5.3 %; 0.863; [0.863, 0.863]; not met"));
        assert!(text.contains("| embree-sah | 0.95 [0.95, 0.95] |"), "{text}");
        let same = told(50.0);
        assert!(same.contains("No target of a build time"), "{same}");
    }
}
