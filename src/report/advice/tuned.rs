//! What a search of parameters found, as text: the configuration, its point, the race, and the front over all tried.

use super::rays_in_words;
use crate::bench::quick::line::{Estimate, TotalTime};
use crate::bench::tune::{Trial, Tuned, mean_ratios};
use crate::report::figures::tree_name;
use crate::report::grid::{Grid, short};
use crate::report::plot::pareto::front;
use crate::report::table::brief::{COLUMNS, filled};

/// Everything that was found for `rays` in `scene`.
pub fn page(tuned: &Tuned, scene: &str, rays: f64) -> String {
    [heading(tuned, scene, rays), fresh(tuned, rays), race(tuned, rays), all(tuned, rays), named(tuned, rays)]
        .join("\n")
}

/// A builder's name, or the number of the trial: whole names are long.
fn name(tuned: &Tuned, trial: &Trial) -> String {
    let place = tuned.trials.iter().position(|known| known.cell == trial.cell);
    match place.filter(|_| !trial.recipe.changes().is_empty()) {
        Some(place) => format!("trial {}", place + 1),
        None => tree_name((&trial.cell.builder, trial.cell.width)),
    }
}

/// The trials on the front, by the one pair of each.
fn on_front(tuned: &Tuned, rays: f64) -> Vec<(usize, [f64; 3])> {
    let points: Vec<[f64; 3]> =
        tuned.trials.iter().map(|trial| mean_ratios(&trial.pairs, rays).map(|ratio| ratio.value)).collect();
    let plane: Vec<(f64, f64)> = points.iter().map(|[build, ray, _]| (*build, *ray)).collect();
    front(&plane).into_iter().map(|i| (i, points[i])).collect()
}

/// What the trials in the tables are.
fn named(tuned: &Tuned, rays: f64) -> String {
    let shown = on_front(tuned, rays).into_iter().map(|(i, _)| &tuned.trials[i]).chain(&tuned.race);
    let mut lines: Vec<String> = Vec::new();
    for trial in shown.filter(|trial| !trial.recipe.changes().is_empty()) {
        let fields = trial.recipe.changes();
        let fields = fields.iter().map(|(field, value)| format!(", {field}={value}")).collect::<String>();
        let tree = tree_name((trial.recipe.base(), trial.cell.width));
        let line = filled(&format!("{}: {tree}{fields}", name(tuned, trial)));
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    lines.concat()
}

fn anchor(tuned: &Tuned) -> String {
    tree_name((&tuned.anchor.builder, tuned.anchor.width))
}

fn shown(ratio: Estimate) -> Vec<String> {
    let ends =
        if ratio.high.is_finite() { format!("[{:.2}, {:.2}]", ratio.low, ratio.high) } else { "?".into() };
    vec![format!("{:.3}", ratio.value), ends]
}

fn heading(tuned: &Tuned, scene: &str, rays: f64) -> String {
    let (tried, failed) = (tuned.trials.len(), tuned.failures.len());
    let failed = match tuned.failures.first() {
        None => String::new(),
        Some((name, reason)) => format!(", {failed} failed (first {name}: {reason})"),
    };
    filled(&format!(
        "{scene}, {} rays: {tried} configurations tried{failed}, each right after {}, which all is relative to",
        rays_in_words(rays),
        anchor(tuned)
    ))
}

/// The winner as it was measured last.
fn fresh(tuned: &Tuned, rays: f64) -> String {
    let best = &tuned.fresh;
    let visits: Vec<_> = best.pairs.iter().map(|pair| pair.tried).collect();
    let [build, ray, total] = mean_ratios(&best.pairs, rays);
    let mut grid = Grid::new(["measured again, other rays", "", "relative", "95 %"]);
    let mut push = |what: &str, value: String, ratio| {
        let cells = [what.to_owned(), value].into_iter().chain(shown(ratio));
        grid.push(cells.collect());
    };
    if let Some(line) = TotalTime::of(&visits) {
        push("build", format!("{} ms", short(line.build_ms.value)), build);
        push("speed", format!("{} Mrays/s", short(1e3 / line.ns_per_ray.value)), inverse(ray));
        push("total time", format!("{} s", short(1e-3 * line.at(rays))), total);
    }
    let (name, configuration) = (name(tuned, best), configuration(best));
    let (grid, verdict, rounds) = (grid.within(COLUMNS), verdict(tuned, rays), best.pairs.len());
    format!("best: {name}, {configuration}\n\n{grid}\nIt {verdict}. {rounds} rounds.\n")
}

/// Whether the winner is what all is relative to.
fn is_anchor(tuned: &Tuned) -> bool {
    tuned.fresh.cell == tuned.anchor
}

/// Whether the winner is better than the anchor, as what follows its name.
pub fn verdict(tuned: &Tuned, rays: f64) -> String {
    let [_, _, total] = mean_ratios(&tuned.fresh.pairs, rays);
    let anchor = anchor(tuned);
    match total {
        // Twice the same: what is measured between them is noise.
        _ if is_anchor(tuned) => format!("is {anchor} itself: nothing better was found"),
        Estimate { high, .. } if high < 1.0 => format!("takes less time in all than {anchor}"),
        Estimate { low, .. } if low > 1.0 => {
            format!("takes MORE time in all than {anchor}: nothing better was found")
        }
        _ => format!("cannot be told apart from {anchor}"),
    }
}

/// The fields that differ from the builder's own.
fn configuration(trial: &Trial) -> String {
    let changes = trial.recipe.changes();
    let fields: String = changes.iter().map(|(field, value)| format!("\n  {field:<32} {value}")).collect();
    let as_it_is = if changes.is_empty() { " as it is" } else { " with" };
    format!("{}, {}-wide,{as_it_is}{fields}", trial.recipe.base(), trial.cell.width)
}

fn inverse(ratio: Estimate) -> Estimate {
    Estimate { value: 1.0 / ratio.value, low: 1.0 / ratio.high, high: 1.0 / ratio.low }
}

/// The race by which it was chosen.
fn race(tuned: &Tuned, rays: f64) -> String {
    let mut grid = Grid::new(["race", "build", "95 %", "ray", "95 %", "total", "95 %"]);
    for trial in &tuned.race {
        let ratios = mean_ratios(&trial.pairs, rays).into_iter().flat_map(shown);
        grid.push(std::iter::once(name(tuned, trial)).chain(ratios).collect());
    }
    grid.within(COLUMNS)
}

/// The front over all trials.
fn all(tuned: &Tuned, rays: f64) -> String {
    let mut grid = Grid::new(["front over all tried, one pair each", "build", "ray", "total"]);
    for (i, figures) in on_front(tuned, rays) {
        let figures = figures.map(|ratio| format!("{ratio:.2}"));
        grid.push(std::iter::once(name(tuned, &tuned.trials[i])).chain(figures).collect());
    }
    grid.within(COLUMNS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::cell::Cell;
    use crate::bench::quick::QuickVisit;
    use crate::bench::tune::Pair;
    use crate::builders::Recipe;

    fn trial(builder: &str, factors: [f64; 2], pairs: usize) -> Trial {
        let visit = |[build, ray]: [f64; 2]| QuickVisit { build_ms: 100.0 * build, ns_per_ray: 100.0 * ray };
        Trial {
            cell: Cell::new(builder, 8, &[]),
            recipe: Recipe::parse(builder).unwrap(),
            pairs: vec![Pair { tried: visit(factors), anchor: visit([1.0, 1.0]) }; pairs],
        }
    }

    #[test]
    fn the_page_has_the_configuration_its_gain_and_the_front() {
        let (best, other) = ("phr-best[phr.delta=5]", "phr-quality[max_cut=4096]");
        let tuned = |fresh| Tuned {
            anchor: Cell::new("phr-quality", 8, &[]),
            trials: vec![
                trial(best, [2.0, 0.8], 1),
                trial(other, [0.9, 1.1], 1),
                trial("phr-hq", [2.0, 1.2], 1),
            ],
            failures: vec![("phr-fast / 4".into(), "it panicked".into())],
            race: vec![trial(best, [2.0, 0.9], 3)],
            fresh,
        };
        let text = page(&tuned(trial(best, [2.0, 0.8], 3)), "a", 1e8);
        for part in [
            "a, 100M rays: 3 configurations tried, 1 failed (first phr-fast / 4: it panicked)",
            "best: trial 1, phr-best, 8-wide, with\n  phr.delta                        5\n",
            "trial 1: phr-best / 8, phr.delta=5\n",
            "| trial 2 ",
            "less time in all",
            "0.812",
            "1.250",
            "trial 2: phr-quality / 8, max_cut=4096",
        ] {
            assert!(text.contains(part), "no {part:?} in\n{text}");
        }
        assert!(!text.contains("phr-hq"), "another is better in both");
        assert!(page(&tuned(trial(best, [2.0, 1.1], 3)), "a", 1e8).contains("MORE time"));
        assert!(page(&tuned(trial(best, [2.0, 0.8], 1)), "a", 1e8).contains("cannot be told apart"));
    }
}
