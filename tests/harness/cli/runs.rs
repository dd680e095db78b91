//! What a run writes.

use super::*;
use phr::bench::environment::State;
use phr::bench::phases::PHASES;
use phr::bench::results_dir;
use phr::bench::rounds::ROUNDS;
use phr::bench::row::{self, ALL, FIRST, FRESH, REBUILD, ROWS, Row};
use phr::bench::samples::SAMPLES;

#[test]
fn a_run_writes_verified_rows_and_its_table() {
    let (_keep, folder) = workplace();
    let output = phr(&folder, &tiny("sheet.ply", &["--rounds", "1"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "", "silence in a pipe");

    let out = folder.join("out");
    let mut files: Vec<String> =
        std::fs::read_dir(&out).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
    files.sort();
    let drawn = ["figure6", "figure6-own", "figure6-paper", "figure6-scenes"];
    let figures: Vec<String> =
        drawn.iter().flat_map(|name| [format!("{name}.png"), format!("{name}.svg")]).collect();
    let mut expected = vec![
        ENVIRONMENT,
        ROUNDS,
        ROWS,
        SAMPLES,
        PHASES,
        "phases.png",
        "phases.svg",
        "report.html",
        "table1.md",
    ];
    if cfg!(feature = "embree") {
        expected.extend(figures.iter().map(String::as_str));
    }
    expected.sort_unstable();
    assert_eq!(files, expected);

    let told = text(&output.stdout);
    let summary = &told[told.find("## out: 1 scene").expect("a summary at the end")..];
    for part in [
        "In sheet on 2 threads",
        "Build and rays together, ",
        "table: out/table1.md",
        "rows:  out/rows.csv",
        "plots: ",
        "page:  out/report.html",
    ] {
        assert!(summary.contains(part), "no {part:?} in {summary}");
    }
    assert_eq!(summary.contains("plots: out/figure6.png"), cfg!(feature = "embree"), "{summary}");

    let rows = row::read(&out).unwrap();
    let totals: Vec<&Row> = rows.iter().filter(|row| row.is_total() && row.verified == Some(true)).collect();
    let mut seen: Vec<(&str, u32)> = totals.iter().map(|row| (row.builder.as_str(), row.width)).collect();
    seen.dedup();
    assert_eq!(seen.len(), trees(), "{seen:?}");
    for row in &rows {
        assert!(row.is_good(), "{row:?}");
        assert_eq!((row.scene.as_str(), row.triangles, row.rounds), ("sheet", 1152, 1));
        assert!(row.build_ms_median.is_some_and(|ms| ms > 0.0));
        assert!([FIRST, FRESH, REBUILD].contains(&row.regime.as_str()));
        assert_eq!(row.host, "anonymous");
    }
    for row in totals {
        assert!(row.rays.is_some_and(|rays| rays >= 256) && row.mrays_s.is_some_and(|speed| speed > 0.0));
        assert!(row.sah.is_some_and(|sah| sah > 1.0));
        let parts = rows.iter().filter(|part| {
            (&part.builder, part.width, &part.kernel) == (&row.builder, row.width, &row.kernel)
                && part.regime == FRESH
                && part.view != ALL
                && part.ray_kind != ALL
        });
        assert_eq!(parts.filter_map(|part| part.rays).sum::<u64>(), row.rays.unwrap());
    }

    let environment = environment(&folder);
    assert_eq!(environment.state, State::Complete);
    let machine = serde_json::to_string(&environment).unwrap();
    assert!(!machine.contains(folder.to_str().unwrap()), "no path of the machine in {machine}");

    let table = phr(&folder, &["table", "out"]);
    assert!(table.status.success());
    let written = std::fs::read_to_string(out.join("table1.md")).unwrap();
    assert_eq!(text(&table.stdout).trim_end(), written.trim_end());
    assert!(written.contains("| phr-fast / 4") && written.contains("sheet: 1 152 triangles"), "{written}");

    results_dir::remove_made_of_rows(&out, &[ENVIRONMENT, ROUNDS, ROWS, SAMPLES, PHASES]).unwrap();
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0, "an older run leaves nothing behind");
}

#[test]
fn the_columns_are_documented() {
    let folder = tempfile::tempdir().unwrap();
    row::write(&folder.path().join(ROWS), &[Row::default()]).unwrap();
    let header = std::fs::read_to_string(folder.path().join(ROWS)).unwrap();
    let readme = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/README.md");
    let readme = std::fs::read_to_string(readme).unwrap();
    for column in header.lines().next().unwrap().split(',') {
        assert!(readme.contains(&format!("`{column}`")), "results/README.md does not tell of {column}");
    }
    for warning in phr::bench::warnings::Warning::ALL {
        assert!(readme.contains(&format!("`{}`", warning.name())), "nor of {warning:?}");
    }
}

#[test]
fn a_generated_scene_needs_no_file() {
    let (_keep, folder) = workplace();
    let name = phr::scene::builtin()[0].name;
    let output = phr(&folder, &tiny(name, &["--rounds", "1", "--filter", "(phr-fast|embree-sah) 4"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let rows = row::read(&folder.join("out")).unwrap();
    assert!(rows.iter().all(|row| row.scene == name && row.is_good()));
    assert!(rows.iter().all(|row| row.width == 4 && row.builder != "lbvh"));
}

#[test]
fn builds_alone_are_timed_without_rays() {
    let (_keep, folder) = workplace();
    let mut arguments = tiny("sheet.ply", &["--rounds", "3", "--build-only"]);
    let refused = phr(&folder, &arguments);
    assert!(text(&refused.stderr).contains("--size"), "nothing is rendered: {}", text(&refused.stderr));
    arguments.retain(|it| !["--size", "16", "--views", "1"].contains(it));
    let output = phr(&folder, &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let rows = row::read(&folder.join("out")).unwrap();
    assert_eq!(rows.len(), 3 * trees());
    assert!(rows.iter().all(|row| row.rounds == 3 && row.verified.is_none() && row.rays.is_none()));
}
