//! The table of a run: per scene a row per builder and width, relative to Embree SAH at width 4, and the
//! means over scenes. Made from the rows alone.

use super::grid::{Grid, short};
use super::means::means;
use super::ratios::{BASELINE, SceneRows, kernels, trees};
use crate::bench::contender::Kernel;
use crate::bench::records::{NO_KERNEL, Row};
use crate::bench::statistics::Ratio;
use crate::bench::warnings::Warning;

/// The whole table of a run as a Markdown document.
pub fn document(rows: &[Row], complete: bool) -> String {
    let mut text = heading(rows);
    if !complete {
        text += "**Part of a run: it was stopped before all rounds of all scenes were done.**\n\n";
    }
    for scene in scenes(rows) {
        text += &(self::scene(rows, &scene) + "\n");
    }
    text + &closing(rows)
}

/// What follows the scenes: means, what the columns mean, errors and warnings.
pub fn closing(rows: &[Row]) -> String {
    let means = if scenes(rows).len() > 1 { means(rows) + "\n" } else { String::new() };
    means + &legend(rows) + &remarks(rows)
}

fn heading(rows: &[Row]) -> String {
    let Some(row) = rows.first() else { return String::new() };
    let mut engines: Vec<&str> =
        rows.iter().map(|row| row.engine.as_str()).filter(|e| !e.is_empty()).collect();
    engines.sort_unstable();
    engines.dedup();
    let (engines, id, utc, revision) = (engines.join(", "), &row.run_id, &row.utc, &row.git_rev);
    format!("# Run {id}\n\n{utc}, revision {revision}; {engines}\n\n")
}

/// The scenes of `rows`, in their order.
pub fn scenes(rows: &[Row]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for row in rows {
        if !names.contains(&row.scene) {
            names.push(row.scene.clone());
        }
    }
    names
}

/// One scene's table, under a heading.
pub fn scene(rows: &[Row], scene: &str) -> String {
    let of_scene = SceneRows::of(rows, scene);
    let kernels = kernels(rows);
    let mut header: Vec<String> =
        ["builder / width", "build ms", "cold", "/SAH", "cost", "/SAH", "EPO"].map(Into::into).into();
    for kernel in &kernels {
        let name = kernel_heading(*kernel);
        header.extend([format!("{name} ms"), "MRays/s".into(), "/SAH".into()]);
    }
    let mut grid = Grid::new(header);
    let own: Vec<Row> = of_scene.0.iter().map(|&row| row.clone()).collect();
    for (builder, width) in trees(&own) {
        let tree = (builder.as_str(), width);
        let Some(build) = of_scene.build(tree) else { continue };
        let cold = of_scene.cold(tree).and_then(|row| row.build_ms_median);
        let mut cells = vec![
            format!("{builder} / {width}"),
            build.build_ms_median.map_or_else(String::new, short),
            cold.map_or_else(String::new, short),
            with_error(of_scene.build_ratio(tree), tree),
            build.sah.map_or_else(String::new, short),
            of_scene.sah_ratio(tree).map_or_else(String::new, |x| format!("{x:.2}")),
            build.epo.map_or_else(String::new, short),
        ];
        for &kernel in &kernels {
            let row = of_scene.trace(tree, kernel);
            cells.push(row.and_then(|row| row.trace_ms_median).map_or_else(String::new, short));
            cells.push(row.and_then(|row| row.mrays_s).map_or_else(String::new, short));
            let baseline = of_scene.trace_baseline(kernel);
            let is_baseline =
                row.is_some() && row.map(std::ptr::from_ref) == baseline.map(std::ptr::from_ref);
            let ratio = of_scene.trace_ratio(tree, kernel);
            cells.push(if is_baseline { "1".into() } else { ratio.map_or_else(String::new, interval) });
        }
        grid.push(cells);
    }
    let triangles = of_scene.0.first().map_or(0, |row| row.triangles);
    let rays = of_scene.0.iter().filter_map(|row| row.rays).max();
    let rays = rays.map_or_else(String::new, |rays| format!(", {} rays", grouped(rays)));
    format!("## {scene}: {} triangles{rays}\n\n{}", grouped(triangles), grid.markdown())
}

/// A kernel's name at the head of a column.
pub(super) fn kernel_heading(kernel: Kernel) -> &'static str {
    match kernel {
        Kernel::EmbreeNative => "native",
        Kernel::EmbreeGrafted => "grafted",
        Kernel::Phr => "phr",
    }
}

fn with_error(ratio: Option<Ratio>, tree: (&str, u32)) -> String {
    if tree == BASELINE { "1".into() } else { ratio.map_or_else(String::new, interval) }
}

/// A ratio with the half width of its interval, where that is known.
fn interval(ratio: Ratio) -> String {
    let half = 0.5 * (ratio.high - ratio.low);
    // An interval wider than the ratio says no more than that nothing is known.
    if half < ratio.value {
        format!("{:.2} ±{half:.2}", ratio.value)
    } else {
        format!("{:.2} ±?", ratio.value)
    }
}

/// Digits in groups of three.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|group| std::str::from_utf8(group).unwrap_or("")).collect();
    groups.join(" ")
}

/// What the columns mean.
fn legend(rows: &[Row]) -> String {
    let Some(row) = rows.first() else { return String::new() };
    let rounds = rows.iter().filter(|row| row.error.is_empty()).map(|row| row.rounds);
    let (least, most) = (rows_min(rounds.clone()), rounds.max().unwrap_or(0));
    let rounds = if least == most { most.to_string() } else { format!("{least} to {most}") };
    let shared = rows.iter().any(|row| {
        row.builder.starts_with("embree") && row.kernel == Kernel::Phr.name() && row.mrays_s.is_some()
    });
    let kernel = if shared {
        "under the same kernel"
    } else {
        "under Embree's kernel, also where ours traced: tree and kernel together"
    };
    format!(
        "Medians of {rounds} rounds, {} threads on each side. /SAH: relative to {} at width {}; traces {kernel}; \
         ± half the 95 % interval. cold: ms of the first build of a fresh builder or device. cost: SAH cost. \
         All recorded rays: native, Embree's kernel on its own tree; grafted, Embree's kernel on any tree, all laid out alike; phr, our kernel.\n",
        row.threads, BASELINE.0, BASELINE.1
    )
}

fn rows_min(rounds: impl Iterator<Item = u32>) -> u32 {
    rounds.min().unwrap_or(0)
}

/// Errors and warnings, each with advice.
pub fn remarks(rows: &[Row]) -> String {
    let mut text = String::new();
    for row in rows.iter().filter(|row| !row.error.is_empty()) {
        let kernel = if row.kernel == NO_KERNEL { String::new() } else { format!(" under {}", row.kernel) };
        let kind = if row.verified == Some(false) { "WRONG HITS" } else { "no figures" };
        text += &format!("\n{kind}: {} {}/{}{kernel}: {}", row.scene, row.builder, row.width, row.error);
    }
    let totals: Vec<&Row> = rows.iter().filter(|row| row.is_total()).collect();
    for warning in Warning::ALL {
        let count = totals.iter().filter(|row| Warning::parse(&row.warnings).any(|w| w == warning)).count();
        if count > 0 {
            text += &format!("\n{}: {count} of {} rows; {}", warning.name(), totals.len(), warning.advice());
        }
    }
    if text.is_empty() { text } else { text + "\n" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::records::{ALL, SCHEMA, WARM};

    fn row(scene: &str, builder: &str, width: u32, kernel: Kernel, build: f64, trace: f64) -> Row {
        Row {
            schema: SCHEMA,
            scene: scene.into(),
            triangles: 1_234_567,
            builder: builder.into(),
            width,
            regime: WARM.into(),
            rounds: 3,
            threads: 2,
            build_ms_median: Some(build),
            build_ms_mad: Some(0.0),
            build_ms_min: Some(build),
            build_ms_max: Some(build),
            sah: Some(build),
            view: ALL.into(),
            ray_kind: ALL.into(),
            kernel: kernel.name().into(),
            rays: Some(1000),
            trace_ms_median: Some(trace),
            trace_ms_mad: Some(0.0),
            trace_ms_min: Some(trace),
            trace_ms_max: Some(trace),
            mrays_s: Some(1.0 / trace),
            verified: Some(true),
            ..Row::default()
        }
    }

    fn rows() -> Vec<Row> {
        vec![
            row("a", "embree-sah", 4, Kernel::EmbreeNative, 10.0, 20.0),
            row("a", "phr-hq", 4, Kernel::Phr, 20.0, 10.0),
            row("b", "phr-hq", 4, Kernel::Phr, 5.0, 40.0),
            row("b", "embree-sah", 4, Kernel::EmbreeNative, 10.0, 20.0),
        ]
    }

    #[test]
    fn ratios_are_to_embree_sah() {
        let text = scene(&rows(), "a");
        assert!(text.starts_with("## a: 1 234 567 triangles, 1 000 rays\n"), "{text}");
        let line = text.lines().find(|line| line.contains("phr-hq / 4")).unwrap();
        assert!(line.contains("2.00 ±0.00") && line.contains("0.50 ±0.00"), "{text}");
    }

    #[test]
    fn means_are_geometric_and_arithmetic_and_name_the_worst() {
        let text = means(&rows());
        let line = text.lines().find(|line| line.contains("phr-hq / 4")).unwrap();
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        // Builds 2 and 0.5, traces 0.5 and 2.
        assert_eq!(&cells[2..7], ["2", "1.000", "1.250", "2.00 a", "1.000"], "{text}");
        assert!(line.contains("2.00 b"), "{text}");
    }

    #[test]
    fn without_embree_there_are_figures_but_no_ratios() {
        let only: Vec<Row> = rows().into_iter().filter(|row| row.builder == "phr-hq").collect();
        let text = document(&only, true);
        assert!(text.contains("phr-hq / 4") && !text.contains("±0"), "{text}");
    }

    #[test]
    fn errors_and_warnings_are_told() {
        let mut rows = rows();
        rows[1] =
            Row { verified: Some(false), mrays_s: None, error: "ray 3 differs".into(), ..rows[1].clone() };
        rows[2].warnings = "HighSpread".into();
        let text = document(&rows, true);
        assert!(text.contains("WRONG HITS: a phr-hq/4 under phr: ray 3 differs"), "{text}");
        assert!(text.contains("HighSpread: 1 of 4 rows"), "{text}");
    }

    #[test]
    fn the_table_is_in_the_papers_order() {
        let order: Vec<String> = trees(&rows()).into_iter().map(|tree| tree.0).collect();
        assert_eq!(order, ["embree-sah", "phr-hq"]);
    }
}
