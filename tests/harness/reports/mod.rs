//! Reports from a small run made by hand: means worked out beside, verdicts and exit codes of the command.

mod comparisons;
mod markers;
mod plots;
mod tables;

use crate::by_hand;
use phr::bench::row::{self, ALL, NO_KERNEL, ROWS, Row, WARM};
use std::path::Path;
use std::process::{Command, Output};

/// Times of four samples whose deviation is a thousandth of their median.
fn row(scene: &str, builder: &str, kernel: &str, view: &str, build: f64, trace: f64) -> Row {
    let about =
        |median: f64| [Some(median), Some(0.001 * median), Some(0.998 * median), Some(1.002 * median)];
    let ([build, build_mad, build_min, build_max], [trace, trace_mad, trace_min, trace_max]) =
        (about(build), about(trace));
    Row {
        regime: WARM.into(),
        build_ms_median: build,
        build_ms_mad: build_mad,
        build_ms_min: build_min,
        build_ms_max: build_max,
        sah: build,
        view: view.into(),
        trace_ms_median: trace,
        trace_ms_mad: trace_mad,
        trace_ms_min: trace_min,
        trace_ms_max: trace_max,
        mrays_s: trace.map(|ms| 1000.0 / ms),
        ..by_hand::row(scene, builder, kernel)
    }
}

/// Two scenes of two views; PHR-HQ builds at 2 and 0.5 of Embree SAH's time and traces at 0.8 and 1.25. Lbvh
/// failed in one scene, hunt-50 is only in the other.
fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for (scene, builder, build, trace) in [
        ("conference-like", "lbvh", 5.0, 40.0),
        ("conference-like", "embree-sah", 10.0, 20.0),
        ("conference-like", "phr-hq", 20.0, 16.0),
        ("yard", "lbvh", 5.0, 40.0),
        ("yard", "hunt-50", 30.0, 200.0),
        ("yard", "embree-sah", 40.0, 100.0),
        ("yard", "phr-hq", 20.0, 125.0),
    ] {
        for view in ["0", "1", ALL] {
            let share = if view == ALL { 1.0 } else { 0.5 };
            rows.push(row(scene, builder, "embree-grafted", view, build, share * trace));
            // Under our kernel everything takes twice the time.
            rows.push(row(scene, builder, "phr", view, build, 2.0 * share * trace));
        }
    }
    rows.retain(|row| (row.scene.as_str(), row.builder.as_str()) != ("yard", "lbvh"));
    let failed = Row {
        build_ms_median: None,
        sah: None,
        trace_ms_median: None,
        mrays_s: None,
        verified: None,
        ..row("yard", "lbvh", NO_KERNEL, ALL, 1.0, 1.0)
    };
    rows.push(Row { error: "out of memory".into(), ..failed });
    rows
}

fn cells<'a>(text: &'a str, heading: &str, method: &str) -> Vec<&'a str> {
    let (_, section) = text.split_once(heading).unwrap_or_else(|| panic!("no {heading} in {text}"));
    let line = section.lines().find(|line| line.starts_with(&format!("| {method} ")));
    line.unwrap_or_else(|| panic!("no {method} in {section}"))
        .trim_matches('|')
        .split('|')
        .map(str::trim)
        .collect()
}

/// The cells behind the method, without intervals and noise.
fn means<'a>(text: &'a str, heading: &str, method: &str) -> Vec<&'a str> {
    let mut cells = cells(text, heading, method);
    cells.retain(|cell| !cell.starts_with(['[', '±']));
    cells.split_off(1)
}

fn phr(arguments: &[&str], folder: &Path) -> (i32, Output) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_phr")).args(arguments).current_dir(folder).output().unwrap();
    (output.status.code().unwrap(), output)
}

fn written(rows: &[Row]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    row::write(&folder.path().join(ROWS), rows).unwrap();
    folder
}
