//! Runs made by hand.

use crate::by_hand;
use phr::bench::row::{self, FIRST, FRESH, NO_KERNEL, REBUILD, Row};
use phr::bench::warnings::Warning;
use phr::report::figures::tree_named;
use std::path::{Path, PathBuf};
use std::process::Command;

const KERNELS: [&str; 2] = ["embree-grafted", "phr"];

/// A tree by its name on the page.
pub fn tree(name: &str) -> (&str, u32) {
    match name.split_once(" / ") {
        Some((builder, width)) => (builder, width.parse().unwrap()),
        None => tree_named(name).unwrap(),
    }
}

fn row(scene: &str, (builder, width): (&str, u32), kernel: &str, build: f64, trace: f64) -> Row {
    let about = |median: f64| [0.001, 0.998, 1.002].map(|share| Some(share * median));
    let ([build_mad, build_min, build_max], [trace_mad, trace_min, trace_max]) = (about(build), about(trace));
    Row {
        width,
        build_ms_median: Some(build),
        build_ms_mad: build_mad,
        build_ms_min: build_min,
        build_ms_max: build_max,
        sah: Some(0.37 * build),
        peak_bytes: Some(33_100_000),
        trace_ms_median: Some(trace),
        trace_ms_mad: trace_mad,
        trace_ms_min: trace_min,
        trace_ms_max: trace_max,
        mrays_s: Some(1000.0 / trace),
        ..by_hand::row(scene, builder, kernel)
    }
}

/// A row of builds alone, in another regime.
fn builds(regime: &str, share: f64, of: &Row) -> Row {
    let build = of.build_ms_median.map(|ms| share * ms);
    Row {
        regime: regime.into(),
        kernel: NO_KERNEL.into(),
        build_ms_median: build,
        rays: None,
        trace_ms_median: None,
        mrays_s: None,
        verified: None,
        ..of.clone()
    }
}

/// Three scenes, one of an awkward name; `lbvh` failed in the last.
pub fn small() -> Vec<Row> {
    let mut rows = Vec::new();
    for (scene, size) in [("a <b>scene</b> & \"more\"", 1.0), ("hall", 3.21), ("yard", 14.7)] {
        for (tree, build, trace) in [
            (("lbvh", 4), 1.234, 40.4),
            (("embree-sah", 4), 12.3456, 20.7),
            (("embree-sah", 8), 11.5, 15.25),
            (("phr-hq", 4), 23.1, 12.125),
        ] {
            if (scene, tree.0) == ("yard", "lbvh") {
                let failed = builds(FRESH, 1.0, &row(scene, tree, NO_KERNEL, build, trace));
                let error = "out of memory".into();
                rows.push(Row { error, build_ms_median: None, sah: None, peak_bytes: None, ..failed });
                continue;
            }
            for (kernel, factor) in KERNELS.into_iter().zip([1.0, 2.0]) {
                rows.push(row(scene, tree, kernel, size * build, factor * size * trace));
            }
            let last = rows.last().unwrap().clone();
            rows.extend([builds(FIRST, 1.5, &last), builds(REBUILD, 0.5, &last)]);
        }
    }
    rows[0].warnings = Warning::join(&[Warning::HighSpread]);
    rows
}

/// `scenes` scenes of eight trees.
pub fn large(scenes: usize) -> Vec<Row> {
    let builders = ["lbvh", "embree-sah", "phr-hq", "phr-best"].into_iter();
    let trees: Vec<(&str, u32)> = builders.flat_map(|builder| [(builder, 4), (builder, 8)]).collect();
    let of_scene = |scene: usize| {
        let trees = trees.clone().into_iter().enumerate();
        trees.flat_map(move |(place, tree)| {
            let (build, trace) =
                (1.0 + (place * 7 + scene) as f64 % 31.0, 1.0 + (place * 11 + scene) as f64 % 29.0);
            KERNELS.map(|kernel| row(&format!("scene-{scene}"), tree, kernel, build, trace))
        })
    };
    (0..scenes).flat_map(of_scene).collect()
}

/// A results folder with these rows.
pub fn folder(rows: &[Row]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    row::write_all(folder.path(), rows).unwrap();
    folder
}

/// Puts a heat map and an experiment into a results folder.
pub fn attach(folder: &Path) {
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20\" height=\"10\"><rect width=\"20\" height=\"10\"/></svg>";
    let experiments = folder.join("experiments");
    std::fs::create_dir(&experiments).unwrap();
    std::fs::write(experiments.join("alpha-delta.csv"), "alpha,delta,ms\n0.55,6,12.5\n# rows: 1\n").unwrap();
    std::fs::write(experiments.join("alpha-delta.svg"), svg).unwrap();
    let pixels = phr::report::plot::raster::png(svg).unwrap();
    std::fs::write(folder.join("heatmap.png"), pixels).unwrap();
}

/// Makes the page of a folder by the command.
pub fn report(folder: &Path) -> PathBuf {
    let output = Command::new(env!("CARGO_BIN_EXE_phr")).arg("report").arg(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join("report.html")
}
