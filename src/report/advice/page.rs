//! Advice as text: all trees by their total time, the best, and which tree is best from how many rays on.

use super::{Advice, Known, rays_in_words};
use crate::bench::quick::line::{Estimate, TotalTime};
use crate::bench::quick::survey::DROPPED;
use crate::report::figures::Under;
use crate::report::grid::{Grid, short};
use crate::report::table::brief::{COLUMNS, filled};

/// Trees named as not told apart from the best.
const NEAR: usize = 4;
/// The share of the time that other programs may hold the processors before that is told.
const BUSY: f64 = 0.1;

/// The whole advice.
pub fn page(advice: &Advice) -> String {
    let Advice { scene, triangles, origin, .. } = advice;
    let heading = filled(&format!("{scene}: {triangles} triangles; {origin}"));
    let told = [legend(advice), verdict(advice) + &unmeasured(advice)].map(|text| filled(text.trim_end()));
    let [legend, verdict] = told;
    [heading, table(advice), legend, verdict, ranges(advice)].join("\n")
}

/// What traced the trees, what the note in the table means, and whether the machine was busy.
fn legend(advice: &Advice) -> String {
    let mut text = format!("Traces: {}.\n", Under::One(advice.kernel.clone()).about());
    if advice.trees.iter().any(|known| known.note == DROPPED) {
        text += "dropped: slower than the best for every number of rays, by more than the intervals; not measured further.\n";
    }
    if advice.busy > BUSY {
        let percent = 100.0 * advice.busy;
        text += &format!(
            "Other programs held the processors {percent:.0} % of the time: another tree may be best. Repeat when idle or with \
             more --seconds.\n"
        );
    }
    text
}

/// How many trees are not known, and what to do about it.
fn unmeasured(advice: &Advice) -> String {
    let (known, all) = (advice.lines().len(), advice.trees.len());
    if known == all || known == 0 {
        return String::new();
    }
    format!(
        "Only {known} of {all} trees were measured: another may be better, give more --seconds (see the notes).\n"
    )
}

/// All trees, those of the least total time first, those without any last. The intervals of build and speed are in the
/// CSV.
fn table(advice: &Advice) -> String {
    let rays = advice.rays;
    let total = format!("{} rays, s", rays_in_words(rays));
    let header = ["tree", "build, ms", "Mrays/s", &total, "95 %", "to best", "rounds", "note"];
    let mut grid = Grid::new(header);
    let mut lines = advice.lines();
    lines.sort_by(|(_, a), (_, b)| a.at(rays).total_cmp(&b.at(rays)));
    let best = lines.first().map_or(f64::NAN, |(_, line)| line.at(rays));
    for (known, line) in &lines {
        let seconds = scaled(line.estimate_at(rays), 1e-3);
        grid.push(vec![
            known.name(),
            short(line.build_ms.value),
            short(1e3 / line.ns_per_ray.value),
            short(seconds.value),
            interval(seconds),
            format!("{:.2}", line.at(rays) / best),
            rounds(known),
            known.note.clone(),
        ]);
    }
    for known in advice.trees.iter().filter(|known| known.line.is_none()) {
        let mut cells = vec![String::new(); header.len()];
        cells[0] = known.name();
        cells[header.len() - 1] = known.note.clone();
        grid.push(cells);
    }
    grid.within(COLUMNS)
}

fn rounds(known: &Known) -> String {
    if known.rounds == 0 { String::new() } else { known.rounds.to_string() }
}

fn scaled(estimate: Estimate, by: f64) -> Estimate {
    Estimate { value: estimate.value * by, low: estimate.low * by, high: estimate.high * by }
}

/// An interval; `?` for one that bounds nothing.
fn interval(estimate: Estimate) -> String {
    if estimate.high.is_finite() && estimate.low > 0.0 {
        format!("[{}, {}]", short(estimate.low), short(estimate.high))
    } else {
        "?".into()
    }
}

/// The best tree for the rays asked for.
fn verdict(advice: &Advice) -> String {
    let rays = advice.rays;
    let Some((best, near)) = advice.best_at(rays) else { return "no tree was measured\n".into() };
    let seconds = best.line.map_or(f64::NAN, |line: TotalTime| 1e-3 * line.at(rays));
    let mut text =
        format!("For {} rays: {}, {} s in all.\n", rays_in_words(rays), best.name(), short(seconds));
    if !near.is_empty() {
        let build = |known: &&Known| known.line.map_or(f64::INFINITY, |line: TotalTime| line.build_ms.value);
        let all = near.iter().copied().chain([best]);
        let shortest = all.min_by(|a, b| build(a).total_cmp(&build(b))).map(Known::name).unwrap_or_default();
        let more = near.len().saturating_sub(NEAR);
        let names: Vec<String> = near.into_iter().take(NEAR).map(Known::name).collect();
        let more = if more == 0 { String::new() } else { format!(" and {more} more") };
        let how = if best.rounds == 0 {
            "Within 5 % of it"
        } else {
            "Not told apart from it, as intervals overlap"
        };
        text +=
            &format!("{how}: {}{more}. Of all these {shortest} has the shortest build.\n", names.join(", "));
    }
    text
}

/// Which tree is best from how many rays on.
fn ranges(advice: &Advice) -> String {
    let mut grid = Grid::new(["best", "from rays", "to"]);
    let winners = advice.winners();
    for (i, (known, from)) in winners.iter().enumerate() {
        let to = winners.get(i + 1).map_or_else(|| "any number".to_owned(), |(_, to)| rays_in_words(*to));
        grid.push(vec![known.name(), rays_in_words(*from), to]);
    }
    grid.markdown()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::quick::QuickVisit;
    use crate::report::advice::tests::advice;

    #[test]
    fn the_page_has_every_tree_the_best_and_the_crossings() {
        let text = page(&advice());
        for part in [
            "a, b: 1000 triangles; made by hand",
            "For 50M rays: phr-best / 8, 5.20 s in all.",
            "\n\nTraces: all trees in Embree's node layout under Embree's kernel (embree-grafted).\ndropped: slower",
            "| lbvh          |         0 |       500k |",
            "|      7.5M | any number |",
            "no time",
            "Only 5 of 6 trees were measured",
        ] {
            assert!(text.contains(part), "no {part:?} in\n{text}");
        }
        let order: Vec<usize> =
            ["phr-best / 8 ", "phr-speed / 8 ", "aac ", "lbvh ", "hunt-50 ", "hunt-500 / 8 "]
                .iter()
                .filter_map(|name| text.find(name))
                .collect();
        assert!(order.len() == 6 && order.is_sorted(), "{order:?}\n{text}");

        let undisturbed = |busy| page(&Advice { busy, ..advice() }) == text;
        assert!(undisturbed(BUSY) && !undisturbed(0.43));
        let mut busy = Advice { busy: 0.43, ..advice() };
        busy.trees.retain(|known| known.note != DROPPED);
        let text = page(&busy);
        let told = "Other programs held the processors 43 % of the time: another tree may be best. Repeat when idle or with more --seconds.\n";
        assert!(text.contains(told) && !text.contains("dropped"), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= 120), "{text}");

        let mut unsure = advice();
        unsure.trees[3].line = TotalTime::of(&[QuickVisit { build_ms: 90.0, ns_per_ray: 150.0 }]);
        let text = page(&unsure);
        assert!(
            text.contains("as intervals overlap: aac. Of all these aac has the shortest build.\n"),
            "{text}"
        );

        let mut failed = advice();
        failed.trees[5].builder = "embree-fast-spatial".into();
        let why = "wrong hits: view 0, ray 17 of 5000, in a scene whose name is long, with all its thousands of triangles";
        failed.trees[5].note = why.into();
        let text = page(&failed);
        assert!(text.contains(&format!("…1: {why}\n")), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= 120), "{text}");
    }
}
