//! The targets of the builders, and whether a run meets them: build and trace time against Embree's builders,
//! memory, one thread against two.

mod fronts;
pub mod growth;
pub mod judge;
pub mod list;

use super::grid::{Grid, short};
use super::means::beside_mean;
use super::table::{remarks, rounds};
use crate::bench::row::Row;
use growth::growth;
use judge::{Judge, Judged, is_at_least, is_of_bytes};
use list::Measure;

/// The targets and the growth of a run and its subfolders; `is_complete` is false where a part was stopped.
pub fn document(rows: &[Row], is_complete: bool) -> String {
    let growth = growth(rows);
    let growth = if growth.is_empty() { growth } else { format!("\n### Growth\n\n{growth}") };
    targets(rows, is_complete) + &growth
}

/// The targets alone.
pub fn targets(rows: &[Row], is_complete: bool) -> String {
    let judge = Judge::new(rows);
    let judged: Vec<Judged> = list::targets().iter().map(|target| judge.judge(target)).collect();
    let mut text = String::new();
    for of_section in judged.chunk_by(|a, b| section(a.target.measure) == section(b.target.measure)) {
        text +=
            &format!("### {}\n\n{}\n", section(of_section[0].target.measure), grid(of_section).markdown());
    }
    let fronts = fronts::fronts(judge.main());
    if !fronts.is_empty() {
        text += &format!("### Embree's trees on the front\n\n{fronts}\n");
    }
    if !is_complete {
        text += "**Part of a run: it was stopped before its end.**\n\n";
    }
    text + LEGEND + &measured(rows) + &remarks(rows)
}

const LEGEND: &str = "Trees of the same width on both sides; scenes of more than 100 k triangles (peak of memory: 1 M). build: medians of \
    builds on warm threads in fresh memory, both sides with equal threads. trace: all recorded rays of all views under embree-grafted, and beside \
    it under phr. mean: geometric of ratios, arithmetic of bytes. 95 %: interval of the mean over scenes and rounds. noise: half its \
    interval over rounds alone. worst: of all scenes, with its own 95 % interval over rounds; not told apart: from the mean, which \
    that interval holds. A target is met if the whole interval of the mean, and where it has a limit that of \
    every scene, is within it, and no scene lacks; not met if one is wholly beyond; else undecided. may exceed: scenes whose \
    intervals reach over the limit, or are beyond it.\n";

fn section(measure: Measure) -> &'static str {
    match measure {
        Measure::Build(_) | Measure::Trace(_) => "Build and trace time",
        Measure::Peak | Measure::PeakTo(_) | Measure::Tree => "Memory, bytes per triangle",
        Measure::Threads => "Build time, one thread against two",
    }
}

fn grid(lines: &[Judged]) -> Grid {
    let header = [
        "builder",
        "width",
        "figure",
        "against",
        "target",
        "mean",
        "95 %",
        "noise",
        "under phr",
        "worst",
        "in",
        "limit",
        "may exceed",
        "scenes",
        "",
    ];
    let mut grid = Grid::new(header);
    for judged in lines {
        let Judged { target, mean, interval, noise, under_phr, worst, .. } = judged;
        let (figure, against) = names(target.measure);
        let show = |value: f64| show(target.measure, value);
        let [worst_value, worst_scene] = match worst.as_ref().zip(*mean) {
            Some((worst, _)) if is_of_bytes(target.measure) => [show(worst.value), worst.scene.clone()],
            Some((worst, mean)) => beside_mean(worst, judged.scenes, mean, 3),
            None => Default::default(),
        };
        let sign = if is_at_least(target.measure) { '≥' } else { '≤' };
        let digits = if is_of_bytes(target.measure) { 0 } else { 2 };
        let limit =
            |limit: Option<f64>| limit.map_or_else(String::new, |limit| format!("{sign} {limit:.digits$}"));
        let scenes = if judged.scenes == judged.of_scenes {
            judged.scenes.to_string()
        } else {
            format!("{} of {}", judged.scenes, judged.of_scenes)
        };
        grid.push(vec![
            target.builder.into(),
            target.width.to_string(),
            figure.into(),
            against.into(),
            limit(target.mean),
            mean.map_or_else(|| "-".into(), show),
            interval.map_or_else(String::new, |interval| interval.shown(3)),
            noise.clone(),
            under_phr.map_or_else(String::new, show),
            worst_value,
            worst_scene,
            limit(target.worst),
            target.worst.map_or_else(String::new, |_| judged.may_exceed.to_string()),
            scenes,
            judged.verdict.cell(),
        ]);
    }
    grid
}

fn names(measure: Measure) -> (&'static str, &'static str) {
    match measure {
        Measure::Build(base) => ("build", base),
        Measure::Trace(base) => ("trace", base),
        Measure::PeakTo(base) => ("peak of the build", base),
        Measure::Peak => ("peak of the build", ""),
        Measure::Tree => ("finished tree", ""),
        Measure::Threads => ("1 thread / 2 threads", ""),
    }
}

fn show(measure: Measure, value: f64) -> String {
    if is_of_bytes(measure) { short(value) } else { format!("{value:.3}") }
}

/// The runs behind the rows: targets measured by different programs are not one measurement.
fn measured(rows: &[Row]) -> String {
    let mut ids: Vec<&str> = Vec::new();
    let mut runs: Vec<String> = Vec::new();
    for row in rows {
        let Row { run_id, utc, git_rev, threads, .. } = row;
        if !ids.contains(&run_id.as_str()) {
            ids.push(run_id);
            let rounds = rounds(rows.iter().filter(|row| row.run_id == *run_id && row.error.is_empty()));
            runs.push(format!("{utc}, revision {git_rev}, threads: {threads}, rounds: {rounds}"));
        }
    }
    if runs.is_empty() { String::new() } else { format!("\nMeasured: {}.\n", runs.join("; ")) }
}
