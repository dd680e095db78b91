//! Builders of other crates in the bench: their trees are built, traced and verified as ours are.
use phr::bench::row::{self, FRESH, Row};
use phr::peers::{obvhs, svenstaro};
use std::process::Command;

#[test]
fn trees_of_other_crates_are_measured_and_verified() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_phr"))
        .current_dir(folder.path())
        .args(["bench", "scalable-2k", "--builder", "obvhs-fast", "--builder", "svenstaro-bvh"])
        .args(["--rounds", "1", "--size", "32", "--views", "1", "--threads", "2", "--out", "out"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    let rows = row::read(&folder.path().join("out")).unwrap();
    assert!(rows.iter().all(Row::is_good));
    let crates = [("obvhs-fast", "obvhs", obvhs::VERSION), ("svenstaro-bvh", "bvh", svenstaro::VERSION)];
    for (builder, name, version) in crates {
        for width in [4, 8] {
            let of_tree = || rows.iter().filter(|row| (row.builder.as_str(), row.width) == (builder, width));
            assert!(of_tree().all(|row| row.engine == format!("{name} {version}")), "{builder} / {width}");
            let traced = |row: &&Row| row.is_total() && row.regime == FRESH && row.trace_ms_median.is_some();
            let kernels: Vec<&str> = of_tree().filter(traced).map(|row| row.kernel.as_str()).collect();
            assert!(kernels.contains(&"phr"), "{builder} / {width} under {kernels:?}");
            assert_eq!(kernels.contains(&"embree-grafted"), cfg!(feature = "graft"), "{kernels:?}");
            assert!(of_tree().filter(traced).all(|row| row.verified == Some(true)), "{builder} / {width}");
        }
    }
}
