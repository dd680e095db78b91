//! `phr advise` and `phr tune` as a user meets them: what they write and what they refuse.
use crate::by_hand;
use phr::bench::files::write_csv;
use phr::bench::row::{self, ROWS, Row};
use phr::report::advice::rows::{ADVICE, AdviceRow};
use std::path::Path;
use std::process::{Command, Output};

fn phr(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_phr")).current_dir(folder).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn told(folder: &Path, arguments: &[&str]) -> String {
    let output = phr(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// The lines of the CSV by column.
fn rows(folder: &Path) -> Vec<std::collections::HashMap<String, String>> {
    let path = folder.join("advice.csv");
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

#[test]
fn advice_by_measurement_has_every_tree_and_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let arguments =
        ["advise", "scalable-2k", "--rays", "2M", "--seconds", "2", "--threads", "2", "--out", "out"];
    let builders = ["--builder", "lbvh", "--builder", "phr-speed", "--set", "phr-hq.delta=7", "--width", "4"];
    let page = told(folder.path(), &[&arguments[..], &builders].concat());
    let rows = rows(&folder.path().join("out"));
    let names: Vec<&str> = rows.iter().map(|row| row["builder"].as_str()).collect();
    assert_eq!(names.len(), 3, "{names:?}");
    for row in &rows {
        assert!(
            ["lbvh", "phr-speed", "phr-hq[delta=7]"].contains(&row["builder"].as_str())
                && row["width"] == "4"
        );
        let figure = |column: &str| row[column].parse::<f64>().unwrap();
        let total = figure("build_ms") + 1e-6 * figure("estimated_ns_per_ray") * 2e6;
        assert!((figure("total_ms") / total - 1.0).abs() < 1e-9, "{row:?}");
        assert!(figure("ns_per_ray") > 0.0 && figure("nodes_per_ray") > 1.0, "{row:?}");
        assert!(page.contains(&row["builder"]), "{page}");
    }
    assert!(page.contains("For 2M rays: ") && page.contains("\nTraces: all trees "), "{page}");
    assert_eq!(page.contains("\ndropped: "), rows.iter().any(|row| row["note"] == "dropped"), "{page}");
    let named = rows.iter().filter(|row| !row["best_from_rays"].is_empty());
    assert!(named.clone().count() > 0 && named.clone().all(|row| row["note"] != "dropped"), "{page}");
    assert!(rows.iter().any(|row| row["best_from_rays"] == "0.0"), "one is best without rays");
    for file in ["advice.svg", "advice.png"] {
        assert!(folder.path().join("out").join(file).metadata().unwrap().len() > 1000);
    }
}

#[test]
fn instant_advice_measures_nothing_and_repeats() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["advise", "scalable-2k", "--rays", "1G", "--instant", "--out", "out"];
    let page = told(folder.path(), &arguments);
    assert!(page.contains("not measured: a model of") && page.contains("For 1G rays: "), "{page}");
    assert_eq!(page, told(folder.path(), &arguments));
    assert!(rows(&folder.path().join("out")).iter().all(|row| row["rounds"] == "0"));
}

#[test]
fn a_tuned_configuration_is_one_that_other_verbs_take() {
    let folder = tempfile::tempdir().unwrap();
    let page = told(
        folder.path(),
        &[
            "tune",
            "scalable-2k",
            "--rays",
            "1M",
            "--seconds",
            "4",
            "--threads",
            "2",
            "--width",
            "8",
            "-o",
            "mine.json",
        ],
    );
    for part in [
        "best: ",
        "phr-quality / 8, which all is relative to",
        "front over all tried",
        "mine.json: tuned-scalable-2k-1M",
    ] {
        assert!(page.contains(part), "no {part:?} in {page}");
    }
    let built = told(folder.path(), &["build", "scalable-2k", "--config", "mine.json"]);
    assert!(built.contains("tuned-scalable-2k-1M, width 8"), "{built}");
    let of_ploc = ["tune", "scalable-2k", "--builder", "ploc", "--rays", "1M", "--seconds", "2"];
    assert!(told(folder.path(), &of_ploc).contains("ploc / 8, which all is relative to"));
}

#[test]
fn what_makes_no_sense_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, reason) in [
        (&["advise", "scalable-2k", "--seconds", "0"][..], "--instant"),
        (&["advise", "scalable-2k", "--kernel", "embree"], "--kernel embree"),
        (&["advise", "nowhere"], "nowhere"),
        (&["advise", "--judge", "nowhere"], "nowhere"),
        (&["tune", "scalable-2k", "--seconds", "0"], "--seconds 0"),
        (
            &["tune", "scalable-2k", "--builder", "embree-sah"],
            "no parameters are known of it; give phr-quality",
        ),
        (&["tune", "scalable-2k", "--width", "6"], "'6' for '--width <N>': give 4 or 8"),
        (&["tune", "scalable-2k", "--kernel", "embree-native"], "--kernel embree-native"),
        (&["tune", "scalable-2k", "-o", "no/where.json"], "no such folder"),
        (&["tune", "scalable-2k", "-o", "a.json", "--name", "phr-hq"], "name"),
    ] {
        let output = phr(folder.path(), arguments);
        let told = text(&output.stderr);
        assert_eq!((output.status.code(), told.lines().count()), (Some(2), 1), "{arguments:?}: {told}");
        assert!(told.contains(reason), "{arguments:?}: {told}");
    }
    for (arguments, useless) in [
        (&["advise", "--judge", "nowhere", "--rays", "1M"][..], "--rays"),
        (&["advise", "--fit", "nowhere", "--model", "m.json", "--seconds", "3"], "--seconds"),
        (&["advise", "scalable-2k", "--instant", "--threads", "1"], "--threads"),
        (&["tune", "--judge", "nowhere", "--seed", "2"], "--seed"),
    ] {
        let output = phr(folder.path(), arguments);
        let told = text(&output.stderr);
        let is_told = told.contains("cannot be used with") && told.contains(useless);
        assert!(output.status.code() == Some(2) && is_told, "{arguments:?}: {told}");
    }
    let output = phr(folder.path(), &["advise", "scalable-2k", "--rays", "many"]);
    assert!(text(&output.stderr).contains("50M"), "{}", text(&output.stderr));
}

#[test]
fn advice_in_files_is_judged_by_a_run() {
    let folder = tempfile::tempdir().unwrap();
    // Build in ms and time per ray in ns of three trees in two scenes: the first is the best for few rays, the last
    // for many.
    let trees = [("lbvh", 10.0, 100.0), ("phr-speed", 50.0, 60.0), ("phr-best", 300.0, 50.0)];
    let rows: Vec<Row> = ["hall", "yard"]
        .iter()
        .flat_map(|scene| trees.map(|(builder, build, ray)| (*scene, builder, build, ray)))
        .map(|(scene, builder, build, ray)| Row {
            build_ms_median: Some(build),
            trace_ms_median: Some(ray),
            sah: Some(50.0),
            epo: Some(1.0),
            leaf_fill: Some(0.9),
            ..by_hand::row(scene, builder, "embree-grafted")
        })
        .collect();
    std::fs::create_dir(folder.path().join("run")).unwrap();
    row::write(&folder.path().join("run").join(ROWS), &rows).unwrap();
    // Right advice for one scene; for the other, the best tree was not measured and the slowest builder looks quick.
    let known = |scene: &str, trees: &[(&str, f64, f64)]| {
        std::fs::create_dir_all(folder.path().join("advice").join(scene)).unwrap();
        let file = folder.path().join("advice").join(scene).join(ADVICE);
        let row = |&(builder, build_ms, ns_per_ray): &(&str, f64, f64)| AdviceRow {
            schema: 2,
            scene: scene.to_owned(),
            builder: builder.to_owned(),
            width: 4,
            build_ms: Some(build_ms),
            ns_per_ray: Some(ns_per_ray),
            ..AdviceRow::default()
        };
        write_csv(&file, &trees.iter().map(row).collect::<Vec<_>>()).unwrap();
    };
    known("hall", &trees);
    known("yard", &[("phr-speed", 50.0, 60.0), ("phr-best", 40.0, 50.0)]);
    let arguments = ["advise", "--judge", "run", "--advice", "advice"];
    let page = told(folder.path(), &arguments);
    assert!(page.contains("Share of 2 scenes") && page.contains("among the 3 trees"), "{page}");
    let share = |rays: &str| {
        let line = page.lines().find(|line| line.starts_with(&format!("| {rays} "))).unwrap();
        line.split('|').nth(2).unwrap().trim().to_owned()
    };
    // 10 + 10 ms against 300 + 5; for 10 G rays phr-best is right.
    assert_eq!([share("100k"), share("10G")], ["50 %", "100 %"], "{page}");
    assert!(page.contains("| yard  | 100k | phr-best |      lbvh | 15.25 |"), "{page}");

    known("cellar", &trees);
    let output = phr(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(2));
    let why = "phr: run: the run has no scene cellar, for which there is advice; add it to the run, or remove the advice\n";
    assert_eq!(text(&output.stderr), why);

    known("yard", &[("lbvh", 10.0, 100.0), ("not-in-the-run", 1.0, 50.0)]);
    std::fs::remove_dir_all(folder.path().join("advice").join("cellar")).unwrap();
    let output = phr(folder.path(), &arguments);
    let told = text(&output.stderr);
    assert!(told.contains("yard is not-in-the-run for 100k rays") && told.lines().count() == 1, "{told}");
}
