//! Rows made by hand.

use crate::by_hand;
use phr::bench::row::{Row, WARM};

const GRAFTED: &str = "embree-grafted";

/// A scene of two million triangles, built with two threads.
pub fn row(scene: &str, builder: &str, kernel: &str, build: f64, trace: f64) -> Row {
    Row {
        triangles: 2_000_000,
        regime: WARM.into(),
        rounds: 3,
        build_ms_median: Some(build),
        build_ms_mad: Some(0.0),
        build_ms_min: Some(build),
        build_ms_max: Some(build),
        sah: Some(0.5 * build),
        epo: Some(0.25 * build),
        bytes: Some(120_000_000),
        peak_bytes: Some(220_000_000),
        trace_ms_median: Some(trace),
        trace_ms_mad: Some(0.0),
        trace_ms_min: Some(trace),
        trace_ms_max: Some(trace),
        ..by_hand::row(scene, builder, kernel)
    }
}

/// Under Embree's kernel `trace`, under ours `own`.
fn rows_of(scene: &str, builder: &str, build: f64, trace: f64, own: f64) -> [Row; 2] {
    [row(scene, builder, GRAFTED, build, trace), row(scene, builder, "phr", build, own)]
}

/// Speed builds at 0.5 and 2.0 of Morton's time, traces at 0.8 and 1.05 of SAH's, under our kernel at 1 and 4.
pub fn rows() -> Vec<Row> {
    [
        rows_of("hall", "embree-morton", 10.0, 130.0, 130.0),
        rows_of("hall", "embree-sah", 40.0, 100.0, 100.0),
        rows_of("hall", "phr-speed", 5.0, 80.0, 100.0),
        rows_of("yard", "embree-morton", 10.0, 130.0, 130.0),
        rows_of("yard", "embree-sah", 40.0, 100.0, 100.0),
        rows_of("yard", "phr-speed", 20.0, 105.0, 400.0),
    ]
    .concat()
}

pub fn with(mut rows: Vec<Row>, is_changed: impl Fn(&Row) -> bool, change: impl Fn(&mut Row)) -> Vec<Row> {
    rows.iter_mut().filter(|row| is_changed(row)).for_each(change);
    rows
}

/// Builds of growing scenes: phr-fast takes 100 ns a triangle and 1.25 as much at 32 M, embree-sah ever 200.
pub fn growing() -> Vec<Row> {
    let build = |builder: &str, millions: u64, ns: f64| Row {
        triangles: millions * 1_000_000,
        ..row(&format!("scalable-{millions}M"), builder, "none", ns * millions as f64, 1.0)
    };
    let mut rows = Vec::new();
    for millions in [32, 1, 4] {
        rows.push(build("phr-fast", millions, if millions == 32 { 125.0 } else { 100.0 }));
        rows.push(build("embree-sah", millions, 200.0));
    }
    rows
}
