//! Reports from a small run made by hand: means worked out beside, verdicts and exit codes of the command.

#![cfg(feature = "harness")]

use phr::bench::row::{self, ALL, NO_KERNEL, ROWS, Row, SCHEMA, WARM};
use phr::bench::{kernels, scaling};
use phr::report::figures::Under;
use phr::report::plot::{self, raster};
use phr::report::{readme, table};
use std::path::Path;
use std::process::{Command, Output};

/// Times of four samples whose deviation is a thousandth of their median.
fn row(scene: &str, builder: &str, kernel: &str, view: &str, build: f64, trace: f64) -> Row {
    let about =
        |median: f64| [Some(median), Some(0.001 * median), Some(0.998 * median), Some(1.002 * median)];
    let ([build, build_mad, build_min, build_max], [trace, trace_mad, trace_min, trace_max]) =
        (about(build), about(trace));
    Row {
        schema: SCHEMA,
        run_id: "by-hand".into(),
        utc: "2026-01-02T03:04:05Z".into(),
        git_rev: "0123456789ab".into(),
        scene: scene.into(),
        scene_sha: format!("sha of {scene}"),
        triangles: 331_000,
        builder: builder.into(),
        engine: "made 1.0".into(),
        width: 4,
        threads: 2,
        regime: WARM.into(),
        rounds: 4,
        build_ms_median: build,
        build_ms_mad: build_mad,
        build_ms_min: build_min,
        build_ms_max: build_max,
        sah: build,
        view: view.into(),
        kernel: kernel.into(),
        ray_kind: ALL.into(),
        rays: Some(1_000_000),
        trace_ms_median: trace,
        trace_ms_mad: trace_mad,
        trace_ms_min: trace_min,
        trace_ms_max: trace_max,
        mrays_s: trace.map(|ms| 1000.0 / ms),
        verified: Some(true),
        ..Row::default()
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

#[test]
fn table_1_has_the_figures_of_the_rows() {
    let text = table::document(&rows(), true);
    // Build ms, cost, ms of one of two views, MRays/s.
    let expected =
        ["phr-hq", "embree-grafted", "20.0", "20.0", "8.00", "62.5", "20.0", "20.0", "62.5", "8.00"];
    assert_eq!(cells(&text, "## Table 1", "phr-hq"), expected);
    assert!(
        text.contains("trace ms: the recorded rays alone") && text.contains("of one view, mean of"),
        "{text}"
    );
    // Rows that are sums alone do not tell of how many views.
    let sums: Vec<Row> = rows().into_iter().filter(Row::is_total).collect();
    let text = table::document(&sums, true);
    assert_eq!(cells(&text, "## Table 1", "phr-hq")[4], "16.0");
    assert!(text.contains("of all views together"), "{text}");
}

#[test]
fn failures_and_gaps_are_told_not_averaged() {
    let text = table::document(&rows(), true);
    assert_eq!(cells(&text, "## Table 1", "lbvh")[6..], ["error", "error", "error", "error"]);
    assert_eq!(cells(&text, "## Table 1", "hunt-50")[2..6], ["-", "-", "-", "-"]);
    assert!(text.contains("No build for conference-like: hunt-50\n"), "{text}");
    assert!(text.contains("no figures: yard lbvh/4: out of memory"), "{text}");
    // One scene is left of lbvh.
    assert_eq!(
        means(&text, "### Build time", "lbvh"),
        ["0.500", "-", "0.500", "-", "0.50", "conference-like", "1"]
    );
}

#[test]
fn means_are_those_worked_out_by_hand() {
    let text = table::document(&rows(), true);
    assert_eq!(cells(&text, "### Build time", "phr-hq")[4..6], ["[0.375, 2.670]", "±0.3 %"]);
    // (2 + 0.5) / 2 and sqrt(2 * 0.5); (0.8 + 1.25) / 2 and sqrt(0.8 * 1.25).
    assert_eq!(
        means(&text, "### Build time", "phr-hq"),
        ["1.250", "1.821", "1.000", "1.636", "2.00", "conference-like", "2"]
    );
    assert_eq!(
        means(&text, "### Trace time", "phr-hq"),
        ["1.025", "0.977", "1.000", "0.975", "1.25", "yard", "2"]
    );
    assert_eq!(cells(&text, "### SAH cost", "phr-hq")[1..3], ["1.250", "0.947"]);
}

#[test]
fn kernels_are_never_mixed_silently() {
    let rows = rows();
    let text = table::document_under(&rows, true, &Under::by_name("phr", &rows).unwrap());
    assert_eq!(cells(&text, "## Table 1", "phr-hq")[..6], ["phr-hq", "phr", "20.0", "20.0", "16.0", "31.2"]);
    assert!(text.contains("all trees under the kernel phr"), "{text}");
    // Without Embree SAH under a kernel there is no ratio under it.
    let without: Vec<Row> =
        rows.iter().filter(|r| r.kernel != "phr" || r.builder != "embree-sah").cloned().collect();
    let text = table::document_under(&without, true, &Under::by_name("phr", &without).unwrap());
    assert!(!text.contains("### Trace time, recorded rays"), "{text}");
    assert!(
        Under::by_name("embree-native", &rows).unwrap_err().contains("there are embree-grafted, phr, own")
    );
}

#[test]
fn the_plot_is_reproducible_and_names_every_method() {
    let rows = rows();
    let under = Under::best(&rows);
    let drawings = plot::figures(&rows, &[], &under);
    assert_eq!(drawings, plot::figures(&rows, &[], &under));
    assert_eq!(
        drawings.iter().map(|drawing| drawing.name).collect::<Vec<_>>(),
        ["figure6", "figure6-paper", "figure6-scenes"]
    );
    for drawing in &drawings {
        // A panel of a scene names the trees on its fronts alone.
        let is_panels = drawing.name == "figure6-scenes";
        let methods: &[&str] =
            if is_panels { &["phr-hq"] } else { &["lbvh", "hunt-50", "embree-sah", "phr-hq"] };
        for method in methods {
            assert!(
                drawing.svg.contains(&format!(">{method}<"))
                    || drawing.svg.contains(&format!(">{method} (1 of 2)<")),
                "{method}"
            );
        }
        let png = raster::png(&drawing.svg, 1.0).unwrap();
        assert_eq!(png, raster::png(&drawing.svg, 1.0).unwrap());
        assert!(png.starts_with(b"\x89PNG"));
    }
    // The paper's points: all by name in the mean, those of Conference in its panel.
    assert!(drawings[1].svg.contains(">embree-fast-spatial<"));
    assert!(drawings[2].svg.contains("paper: Conference"));
}

#[test]
fn the_command_draws_and_checks() {
    let folder = written(&rows());
    assert_eq!(phr(&["plot", "."], folder.path()).0, 0);
    let first = std::fs::read(folder.path().join("figure6.png")).unwrap();
    assert_eq!(phr(&["plot", ".", "--check"], folder.path()).0, 0);
    assert_eq!(phr(&["plot", "rows.csv"], folder.path()).0, 0);
    assert_eq!(std::fs::read(folder.path().join("figure6.png")).unwrap(), first);

    let mut changed = rows();
    changed.iter_mut().filter(|row| row.builder == "phr-hq").for_each(|row| row.trace_ms_median = Some(17.0));
    row::write(&folder.path().join(ROWS), &changed).unwrap();
    assert_eq!(phr(&["plot", ".", "--check"], folder.path()).0, 1);
}

#[test]
fn comparisons_exit_with_their_verdict() {
    let a = written(&rows());
    let scaled = |factor: f64| {
        let mut rows = rows();
        for row in rows.iter_mut().filter(|row| row.builder == "phr-hq") {
            let scale = |time: &mut Option<f64>| *time = time.map(|time| factor * time);
            scale(&mut row.trace_ms_median);
            scale(&mut row.trace_ms_mad);
        }
        written(&rows)
    };
    let compare = |b: &Path, more: &[&str]| {
        let (code, output) =
            phr(&[&["compare", a.path().to_str().unwrap(), b.to_str().unwrap()], more].concat(), b);
        (code, String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, text, _) = compare(a.path(), &["--all"]);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("conference-like phr-hq/4, 2 threads: warm build"), "{text}");
    assert!(text.contains("0 slower, 0 inconclusive, 0 faster"), "{text}");

    // Slower by 20 %: two kernels, three views, two scenes.
    let (code, text, error) = compare(scaled(1.2).path(), &[]);
    assert_eq!((code, error.lines().count()), (1, 1), "{error}");
    assert!(text.contains("threshold 5.00 %: 12 slower, 0 inconclusive, 0 faster"), "{text}");
    assert_eq!(compare(scaled(1.2).path(), &["--threshold", "30%"]).0, 0);
    let (code, text, _) = compare(scaled(1.2).path(), &["--totals"]);
    assert!(code == 1 && text.contains(" 4 slower"), "{text}");

    let (code, text, _) = compare(scaled(0.8).path(), &[]);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("12 faster"), "{text}");

    // At the threshold no interval decides.
    let (code, text, error) = compare(scaled(1.05).path(), &[]);
    assert_eq!((code, error.lines().count()), (3, 1), "{text}{error}");
    assert!(text.contains("0 slower, 12 inconclusive, 0 faster"), "{text}");
}

#[test]
fn comparisons_name_what_they_cannot_compare() {
    let a = written(&rows());
    let mut rows = rows();
    rows.retain(|row| row.builder != "hunt-50");
    rows.iter_mut()
        .filter(|row| row.scene == "conference-like")
        .for_each(|row| row.scene_sha = "another".into());
    for row in
        rows.iter_mut().filter(|row| row.scene == "yard" && row.builder == "phr-hq" && row.kernel == "phr")
    {
        (row.verified, row.error) = (Some(false), "ray 7 differs".into());
    }
    let b = written(&rows);
    let (code, output) = phr(&["compare", a.path().to_str().unwrap(), "."], b.path());
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(code, 1, "{text}");
    assert!(text.contains("only in A: yard hunt-50/4, 2 threads, phr\n"), "{text}");
    assert!(text.contains("other geometry or other rays: conference-like phr-hq/4, 2 threads\n"), "{text}");
    assert!(text.contains("failed in B: yard phr-hq/4 phr: ray 7 differs\n"), "{text}");
}

#[test]
fn bad_input_is_one_line_and_code_2() {
    let folder = written(&rows());
    std::fs::write(folder.path().join("empty.md"), "# Nothing\n").unwrap();
    std::fs::write(folder.path().join("open.md"), "<!-- means: . -->\n").unwrap();
    for arguments in [
        &["compare", ".", "nowhere"][..],
        &["compare", ".", ".", "--threshold", "0.05"],
        &["plot", "nowhere"],
        &["plot", ".", "--kernel", "embree-native"],
        &["table", ".", "--kernel", "fastest"],
        &["readme", "nowhere.md"],
        &["readme", "empty.md"],
        &["readme", "open.md"],
    ] {
        let (code, output) = phr(arguments, folder.path());
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(code, 2, "{arguments:?}: {error}");
        // The parser of arguments adds how to get help.
        assert!(
            error.lines().count() == 1 || error.starts_with("error: invalid value"),
            "{arguments:?}: {error}"
        );
    }
}

#[test]
fn a_changed_figure_fails_the_check() {
    let folder = written(&rows());
    let readme = folder.path().join("README.md");
    let text = "# Text\n\nPHR-HQ traces in <!-- value: . geometric trace phr-hq -->?<!-- end --> of the time.\n\n\
                <!-- means: . --kernel phr -->\n<!-- end -->\n\n```\n<!-- means: nowhere -->\n```\n";
    std::fs::write(&readme, text).unwrap();
    assert_eq!(phr(&["readme", "--check", "README.md"], folder.path()).0, 1);
    assert_eq!(std::fs::read_to_string(&readme).unwrap(), text, "a check writes nothing");
    assert_eq!(phr(&["readme", "README.md"], folder.path()).0, 0);
    let made = std::fs::read_to_string(&readme).unwrap();
    assert!(made.contains("-->1.00 [0.73, 1.37]<!-- end --> of the time."), "{made}");
    assert!(made.contains("### Build time\n") && made.contains("<!-- means: nowhere -->"), "{made}");
    assert_eq!(phr(&["readme", "--check", "README.md"], folder.path()).0, 0);

    std::fs::write(&readme, made.replace("1.821", "1.812")).unwrap();
    let (code, output) = phr(&["readme", "--check", "README.md"], folder.path());
    let shown = String::from_utf8(output.stdout).unwrap();
    assert_eq!(code, 1);
    assert!(
        shown.contains("-| phr-hq") && shown.contains("+| phr-hq") && shown.lines().count() == 3,
        "{shown}"
    );
}

#[test]
fn the_summary_has_the_means_and_the_worst_trace() {
    let folder = written(&rows());
    let made = |asked: &str| {
        let text = format!("<!-- summary: . {asked} -->\n<!-- end -->\n");
        readme::regenerate(&text, folder.path()).map_err(|error| error.to_string())
    };
    let text = made("embree-sah phr-hq").unwrap();
    assert_eq!(
        cells(&text, "<!--", "phr-hq"),
        ["phr-hq", "1.00 [0.37, 2.67]", "1.00 [0.73, 1.37]", "1.25", "yard", "1.00 [0.38, 2.67]"]
    );
    assert_eq!(cells(&text, "<!--", "embree-sah")[1..], ["1.00", "1.00", "", "", "1.00"]);
    assert!(text.contains("over 2 scenes, 2 threads"), "{text}");
    for unknown in ["aac", "phr-hq/8", "phr-hq/wide"] {
        assert!(made(unknown).unwrap_err().contains(&format!("trace and cost of {unknown}")));
    }
}

#[test]
fn markers_are_told_by_line() {
    let folder = written(&rows());
    let wrong = |text: &str| readme::regenerate(text, folder.path()).unwrap_err().to_string();
    assert!(wrong("\n<!-- end -->\n").starts_with("line 2: <!-- end --> without a beginning"));
    assert!(
        wrong("<!-- means: . -->\n<!-- table1: . -->\n<!-- end -->\n").starts_with("line 1: means without")
    );
    assert!(wrong("<!-- value: . mean trace phr-hq -->1<!-- end -->").contains("no mean mean"));
    assert!(wrong("<!-- value: . geometric trace aac -->1<!-- end -->").contains("no such figure of aac"));
    assert!(wrong("<!-- means: nowhere -->\n<!-- end -->").starts_with("line 1: "));
    assert!(wrong("<!-- a comment -->\n").starts_with("no marker"));
}

#[test]
fn every_column_and_marker_is_described() {
    let folder = written(&rows());
    let text = std::fs::read_to_string(folder.path().join(ROWS)).unwrap();
    let described = include_str!("../results/README.md");
    let kernels = folder.path().join(kernels::row::KERNELS);
    kernels::row::write(&kernels, &[kernels::row::KernelRow::default()]).unwrap();
    let kernels = std::fs::read_to_string(kernels).unwrap();
    let scaling = folder.path().join(scaling::row::SCALING);
    scaling::row::write(&scaling, &[scaling::row::ScalingRow::default()]).unwrap();
    let scaling = std::fs::read_to_string(scaling).unwrap();
    for column in [text, kernels, scaling].iter().flat_map(|text| text.lines().next().unwrap().split(',')) {
        assert!(described.contains(&format!("`{column}`")), "{column}");
    }
    let markers = [
        "table", "table1", "means", "scenes", "run", "value", "summary", "targets", "growth", "ablation",
        "kernels", "scaling", "advice",
    ];
    for marker in markers {
        assert!(described.contains(&format!("| `{marker}: ")), "{marker}");
        // What is described is understood: up to the rows, which are not there.
        let asked = match marker {
            "value" => "nowhere geometric trace aac",
            "ablation" => "nowhere phr-hq aac",
            "summary" => "nowhere aac",
            _ => "nowhere",
        };
        let text = format!("<!-- {marker}: {asked} -->\n<!-- end -->\n");
        let error = readme::regenerate(&text, folder.path()).unwrap_err().to_string();
        assert!(error.contains("nowhere"), "{error}");
    }
}
