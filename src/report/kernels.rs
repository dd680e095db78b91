//! Tables of kernels: each scene in full, and the targets over scenes.

use super::grid::{Grid, short};
use crate::bench::kernels::row::{KernelRow, SINGLE};
use crate::bench::statistics::geometric_mean;
use crate::random::SplitMix64;

/// Our single rays and our batches.
const OURS: &str = "phr";
const BATCH: &str = "phr-batch";

/// A target: one of our kernels against Embree's.
struct Target {
    what: &'static str,
    kernel: &'static str,
    /// Against Embree's single rays, or against the fastest of its kernels.
    against_fastest: bool,
    kind: &'static str,
    width: u32,
    /// The speed aimed at, in the geometric mean over scenes.
    at_least: f64,
}

const fn single(what: &'static str, kind: &'static str, width: u32, at_least: f64) -> Target {
    Target { what, kernel: OURS, against_fastest: false, kind, width, at_least }
}

const fn batch(what: &'static str, kind: &'static str, width: u32, at_least: f64) -> Target {
    Target { what, kernel: BATCH, against_fastest: true, kind, width, at_least }
}

const TARGETS: [Target; 10] = [
    single("closest hit of bounce rays", "bounce", 8, 1.2),
    single("any hit of shadow rays", "shadow", 8, 1.15),
    single("closest hit of bounce rays", "bounce", 4, 1.15),
    single("any hit of shadow rays", "shadow", 4, 1.1),
    batch("batches of camera rays", "primary", 8, 1.0),
    batch("batches of bounce rays", "bounce", 8, 1.25),
    batch("batches of shadow rays", "shadow", 8, 1.25),
    batch("batches of camera rays", "primary", 4, 1.0),
    batch("batches of bounce rays", "bounce", 4, 1.25),
    batch("batches of shadow rays", "shadow", 4, 1.25),
];

/// The figures of one scene: million rays per second, and relative to Embree's single rays over the same tree.
pub fn scene_table(rows: &[KernelRow], scene: &str) -> String {
    let rows: Vec<&KernelRow> = rows.iter().filter(|row| row.scene == scene).collect();
    let kinds = ["primary", "bounce", "shadow"];
    let mut grid = Grid::new([scene, "width", "threads", "kernel", kinds[0], kinds[1], kinds[2]]);
    let mut seen = Vec::new();
    for row in &rows {
        let key = (&row.builder, row.width, row.threads, &row.kernel);
        if seen.contains(&key) {
            continue;
        }
        seen.push(key);
        let figure = |kind: &str| {
            let same = |other: &&&KernelRow| {
                other.ray_kind == kind && (&other.builder, other.width, other.threads, &other.kernel) == key
            };
            rows.iter().find(same).map_or_else(String::new, |row| {
                let ratio = row.ratio.map_or_else(String::new, |ratio| format!(" ({ratio:.2})"));
                let wrong = if row.verified { "" } else { " WRONG" };
                format!("{}{ratio}{wrong}", short(row.mrays_s))
            })
        };
        let mut cells =
            vec![row.builder.clone(), row.width.to_string(), row.threads.to_string(), row.kernel.clone()];
        cells.extend(kinds.map(figure));
        grid.push(cells);
    }
    grid.markdown()
}

/// The targets over all scenes: geometric mean with its 95 % interval, the worst scene, the verdict.
pub fn summary(rows: &[KernelRow]) -> String {
    let mut threads: Vec<u32> = rows.iter().map(|row| row.threads).collect();
    threads.sort_unstable();
    threads.dedup();
    let header = [
        "what", "width", "threads", "against", "at least", "mean", "95 %", "worst", "in", "scenes", "verdict",
    ];
    let mut grid = Grid::new(header);
    for target in &TARGETS {
        for &threads in &threads {
            let ratios = ratios(rows, target, threads);
            let values: Vec<f64> = ratios.iter().map(|ratio| ratio.1).collect();
            let Some(mean) = geometric_mean(&values) else { continue };
            let (low, high) = interval(&values);
            let worst = ratios.iter().min_by(|a, b| a.1.total_cmp(&b.1));
            let verdict = match target.at_least {
                bar if low >= bar => "met",
                bar if high < bar => "not met",
                _ => "undecided",
            };
            let against = match (target.against_fastest, target.kind) {
                (true, _) => "Embree's fastest",
                (false, "shadow") => "rtcOccluded1",
                (false, _) => "rtcIntersect1",
            };
            grid.push(vec![
                target.what.into(),
                target.width.to_string(),
                threads.to_string(),
                against.into(),
                format!("{:.2}", target.at_least),
                format!("{mean:.2}"),
                format!("{low:.2} to {high:.2}"),
                worst.map_or_else(String::new, |worst| format!("{:.2}", worst.1)),
                worst.map_or_else(String::new, |worst| worst.0.to_owned()),
                values.len().to_string(),
                verdict.into(),
            ]);
        }
    }
    let about = rows.first().map_or_else(String::new, |row| {
        let isa = |ours: bool| {
            rows.iter().find(|row| row.kernel.starts_with("phr") == ours).map_or("-", |row| &row.isa)
        };
        let unverified = rows.iter().filter(|row| !row.verified).count();
        let verified = if unverified == 0 {
            "all hits verified".to_owned()
        } else {
            format!("{unverified} rows of wrong hits")
        };
        format!(
            "\n{}, revision {}, {}; our kernels {}, Embree's {}; {verified}.\n",
            row.utc,
            row.git_rev,
            row.cpu,
            isa(true),
            isa(false)
        )
    });
    if grid.is_empty() { about } else { grid.markdown() + &about }
}

/// For a page: the targets, with every scene folded away.
pub fn page(rows: &[KernelRow]) -> String {
    let mut scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    scenes.dedup();
    let each: String = scenes.iter().map(|scene| scene_table(rows, scene) + "\n").collect();
    let legend = "Million rays per second, in brackets relative to Embree's single rays over the same tree.";
    format!("{}\n<details><summary>Every scene</summary>\n\n{legend}\n\n{each}</details>\n", summary(rows))
}

/// Our speed relative to Embree's by scene, over the tree of Embree's SAH builder.
fn ratios<'r>(rows: &'r [KernelRow], target: &Target, threads: u32) -> Vec<(&'r str, f64)> {
    let all: Vec<&KernelRow> = rows
        .iter()
        .filter(|row| row.builder == "embree-sah" && row.width == target.width)
        .filter(|row| row.ray_kind == target.kind && row.threads == threads)
        .collect();
    let ours = all.iter().filter(|row| row.kernel == target.kernel);
    let ratio = |ours: &&&'r KernelRow| {
        let theirs = all.iter().filter(|row| row.scene == ours.scene && row.kernel.starts_with("embree-"));
        let theirs = theirs.filter(|row| target.against_fastest || row.kernel == SINGLE);
        let fastest = theirs.map(|row| row.mrays_s).max_by(f64::total_cmp)?;
        Some((ours.scene.as_str(), ours.mrays_s / fastest))
    };
    ours.collect::<Vec<_>>().iter().filter_map(ratio).collect()
}

/// The middle 95 % of geometric means over scenes drawn again; seeded, so that the table is always the same.
fn interval(values: &[f64]) -> (f64, f64) {
    const DRAWS: usize = 2000;
    let mut random = SplitMix64::new(1);
    let mut draw = || (0..values.len()).map(|_| values[random.below(values.len())]).collect::<Vec<_>>();
    let mut means: Vec<f64> = (0..DRAWS).filter_map(|_| geometric_mean(&draw())).collect();
    means.sort_by(f64::total_cmp);
    match means.len() {
        0 => (0.0, f64::INFINITY),
        count => (means[count / 40], means[count - 1 - count / 40]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(scene: &str, kernel: &str, mrays_s: f64) -> KernelRow {
        let text = |text: &str| text.to_owned();
        KernelRow {
            scene: text(scene),
            builder: text("embree-sah"),
            width: 8,
            threads: 1,
            kernel: text(kernel),
            ray_kind: text("shadow"),
            mrays_s,
            ratio: Some(mrays_s / 2.0),
            verified: true,
            ..KernelRow::default()
        }
    }

    #[test]
    fn batches_are_judged_by_the_fastest_of_the_same_scene() {
        let rows: Vec<KernelRow> = ["a", "b"]
            .iter()
            .flat_map(|scene| {
                [
                    row(scene, SINGLE, 2.0),
                    row(scene, "embree-stream", 4.0),
                    row(scene, OURS, 2.5),
                    row(scene, BATCH, 6.0),
                ]
            })
            .chain([row("c", BATCH, 1.0)])
            .collect();
        let summary = summary(&rows);
        let line = |what: &str| summary.lines().find(|line| line.contains(what)).unwrap().replace(' ', "");
        assert!(line("batches of shadow rays").contains("|1.25|1.50|1.50to1.50|1.50|a|2|met|"), "{summary}");
        assert!(line("any hit of shadow").contains("|1.15|1.25|1.25to1.25|1.25|a|2|met|"), "{summary}");
        assert!(!summary.contains("bounce") && summary.contains("all hits verified"), "{summary}");
    }

    #[test]
    fn a_scene_is_shown_with_its_ratios_and_its_faults() {
        let wrong = KernelRow { verified: false, ..row("a", OURS, 3.0) };
        let table = scene_table(&[row("a", SINGLE, 2.0), wrong, row("b", OURS, 9.0)], "a");
        assert!(table.contains("2.00 (1.00)") && table.contains("3.00 (1.50) WRONG"), "{table}");
        assert!(!table.contains("9.00"), "{table}");
    }
}
