//! Targets, growth and ablations from rows made by hand, every figure worked out beside.

#![cfg(feature = "harness")]

use phr::bench::row::{self, ALL, ROWS, Row, SCHEMA, WARM};
use phr::report::ablation::Ablation;
use phr::report::figures::{Place, Under};
use phr::report::targets::growth::{Growth, growth};
use phr::report::targets::judge::{Judge, Judged, Verdict};
use phr::report::targets::list::{Measure, TARGETS, Target};
use phr::report::targets::{document, targets};
use phr::report::{plot, readme};
use std::path::Path;
use std::process::{Command, Output};

const GRAFTED: &str = "embree-grafted";

/// A scene of two million triangles, built with two threads.
fn row(scene: &str, builder: &str, kernel: &str, build: f64, trace: f64) -> Row {
    Row {
        schema: SCHEMA,
        run_id: "by-hand".into(),
        utc: "2026-01-02T03:04:05Z".into(),
        git_rev: "0123456789ab".into(),
        scene: scene.into(),
        scene_sha: format!("sha of {scene}"),
        triangles: 2_000_000,
        builder: builder.into(),
        engine: "made 1.0".into(),
        width: 4,
        threads: 2,
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
        view: ALL.into(),
        kernel: kernel.into(),
        ray_kind: ALL.into(),
        rays: Some(1_000_000),
        trace_ms_median: Some(trace),
        trace_ms_mad: Some(0.0),
        trace_ms_min: Some(trace),
        trace_ms_max: Some(trace),
        verified: Some(true),
        ..Row::default()
    }
}

/// Under Embree's kernel `trace`, under ours `own`.
fn rows_of(scene: &str, builder: &str, build: f64, trace: f64, own: f64) -> [Row; 2] {
    [row(scene, builder, GRAFTED, build, trace), row(scene, builder, "phr", build, own)]
}

/// Speed builds at 0.5 and 2.0 of Morton's time, traces at 0.8 and 1.05 of SAH's, under our kernel at 1 and 4.
fn rows() -> Vec<Row> {
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

fn with(mut rows: Vec<Row>, is_changed: impl Fn(&Row) -> bool, change: impl Fn(&mut Row)) -> Vec<Row> {
    rows.iter_mut().filter(|row| is_changed(row)).for_each(change);
    rows
}

fn judged(rows: &[Row], builder: &str, measure: Measure) -> Judged {
    let target = TARGETS.iter().find(|target| target.builder == builder && target.measure == measure);
    Judge::new(rows).judge(target.unwrap_or_else(|| panic!("no target of {builder}, {measure:?}")))
}

fn near(value: Option<f64>, expected: f64) -> bool {
    value.is_some_and(|value| (value - expected).abs() < 1e-9)
}

fn phr(arguments: &[&str], folder: &Path) -> (i32, Output) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_phr"));
    let output = command.args(arguments).current_dir(folder).output().unwrap();
    (output.status.code().unwrap(), output)
}

fn written(folder: &Path, rows: &[Row]) {
    std::fs::create_dir_all(folder).unwrap();
    row::write(&folder.join(ROWS), rows).unwrap();
}

fn worst(judged: &Judged) -> Option<(&str, f64)> {
    judged.worst.as_ref().map(|worst| (worst.scene.as_str(), worst.value))
}

const BUILD: Measure = Measure::Build("embree-morton");
const TRACE: Measure = Measure::Trace("embree-sah");

#[test]
fn means_and_worst_scenes_are_those_worked_out_by_hand() {
    // sqrt(0.5 * 2) = 1, at the limit; two scenes so far apart decide nothing.
    let build = judged(&rows(), "phr-speed", BUILD);
    assert!(near(build.mean, 1.0) && build.under_phr.is_none(), "{build:?}");
    assert_eq!((worst(&build), &build.verdict), (Some(("yard", 2.0)), &Verdict::Undecided));
    assert_eq!((build.scenes, build.of_scenes, build.noise.as_str()), (2, 2, ""));
    // Both scenes twice or neither: the ends are 0.5 and 2, deviations enlarged by sqrt(2 / 1) as of two scenes.
    let interval = build.interval.unwrap();
    let end = 2f64.powf(2f64.sqrt());
    assert!(near(Some(interval.high), end) && near(Some(interval.low), 1.0 / end), "{interval:?}");
    // sqrt(0.8 * 1.05) under Embree's kernel, sqrt(1 * 4) under ours; 1.05 is the limit of the worst.
    let trace = judged(&rows(), "phr-speed", TRACE);
    assert!(near(trace.mean, 0.84f64.sqrt()) && near(trace.under_phr, 2.0), "{trace:?}");
    assert_eq!((worst(&trace), &trace.verdict), (Some(("yard", 1.05)), &Verdict::Undecided));
}

/// Times of phr-speed in both scenes.
fn alike(time: f64) -> Vec<Row> {
    with(
        rows(),
        |row| row.builder == "phr-speed",
        |row| (row.build_ms_median, row.trace_ms_median) = (Some(time), Some(10.0 * time)),
    )
}

#[test]
fn the_whole_interval_must_be_within_the_limits() {
    let verdict = |rows: &[Row], measure| judged(rows, "phr-speed", measure).verdict;
    assert_eq!(verdict(&alike(10.0), BUILD), Verdict::Met, "at the limit");
    assert_eq!(verdict(&alike(10.001), BUILD), Verdict::NotMet);
    assert_eq!(verdict(&alike(9.0), TRACE), Verdict::Met);
    // The mean is undecided, the worst is beyond its limit.
    let slower = |time: f64| {
        with(
            rows(),
            |row| row.builder == "phr-speed" && row.scene == "yard",
            move |row| row.trace_ms_median = Some(time),
        )
    };
    let trace = judged(&slower(105.1), "phr-speed", TRACE);
    assert!(trace.mean.is_some_and(|mean| mean < 1.0), "the mean alone would do: {trace:?}");
    assert_eq!(trace.verdict, Verdict::NotMet);
    assert_eq!(verdict(&slower(104.9), TRACE), Verdict::Undecided);
    // Noise of rounds: medians that deviate by a tenth.
    let noisy = with(alike(9.9), |_| true, |row| row.build_ms_mad = row.build_ms_median.map(|ms| 0.1 * ms));
    let build = judged(&noisy, "phr-speed", BUILD);
    assert!(build.verdict == Verdict::Undecided && build.noise.starts_with('±'), "{build:?}");
    // The same deviations in step with Morton's are no noise.
    let by_round = |row: &Row, ms: f64| {
        let drift = [0.9, 1.0, 1.1, 1.0].map(|factor| factor * ms);
        let times = (0..).zip(drift).collect();
        Row { by_round: phr::bench::rounds::RowRounds { build: times, ..Default::default() }, ..row.clone() }
    };
    let paired: Vec<Row> = noisy.iter().map(|row| by_round(row, row.build_ms_median.unwrap())).collect();
    assert_eq!(verdict(&paired, BUILD), Verdict::Met);
}

#[test]
fn bytes_are_of_large_scenes() {
    let small = with(rows(), |row| row.scene == "yard", |row| row.triangles = 1_000_000);
    let peak = judged(&small, "phr-speed", Measure::Peak);
    assert!(near(peak.mean, 110.0), "{peak:?}");
    assert_eq!((peak.scenes, &peak.verdict), (1, &Verdict::Met));
    // 60 and 120: the worst is too much.
    let tree = judged(&small, "phr-speed", Measure::Tree);
    assert!(near(tree.mean, 90.0), "{tree:?}");
    assert_eq!((worst(&tree), &tree.verdict), (Some(("yard", 120.0)), &Verdict::NotMet));
    assert_eq!(judged(&small, "embree-sah", Measure::Tree).verdict, Verdict::NoTarget);
    let tiny = with(rows(), |_| true, |row| row.triangles = 100_000);
    assert_eq!(judged(&tiny, "phr-speed", BUILD).of_scenes, 0);
}

/// One thread takes 1.85 of the time of two in the hall; that of the yard is of another run.
#[test]
fn threads_are_compared_where_both_were_measured() {
    let run = "by-hand";
    let one = |scene: &str, builder: &str, build: f64, run: &str| Row {
        threads: 1,
        run_id: run.into(),
        kernel: "none".into(),
        ..row(scene, builder, "none", build, 1.0)
    };
    let mut all = rows();
    all.push(one("hall", "phr-speed", 9.25, run));
    all.push(one("hall", "embree-sah", 60.0, run));
    all.push(one("yard", "phr-speed", 80.0, "another"));
    let ours = judged(&all, "phr-speed", Measure::Threads);
    assert!(near(ours.mean, 1.85), "{ours:?}");
    assert_eq!((ours.scenes, ours.of_scenes, ours.verdict), (1, 2, Verdict::Undecided), "one scene of two");
    let embree = judged(&all, "embree-sah", Measure::Threads);
    assert!(near(embree.mean, 1.5) && embree.verdict == Verdict::NoTarget, "{embree:?}");
    // The rows of one thread have no part in the other targets.
    assert!(near(judged(&all, "phr-speed", BUILD).mean, 1.0));

    all.push(one("yard", "phr-speed", 36.0, run));
    all.retain(|row| row.run_id != "another");
    let ours = judged(&all, "phr-speed", Measure::Threads);
    assert_eq!(
        (worst(&ours), &ours.verdict),
        (Some(("yard", 1.8)), &Verdict::Undecided),
        "the least is worst"
    );
    let none = judged(&rows(), "phr-speed", Measure::Threads);
    assert_eq!((none.of_scenes, none.verdict), (0, Verdict::NotMeasured));
}

#[test]
fn what_is_missing_is_not_measured_and_what_failed_is_not_met() {
    let best = judged(&rows(), "phr-best", Measure::Build("embree-fast-spatial"));
    assert_eq!((best.mean, best.worst, best.verdict), (None, None, Verdict::NotMeasured));
    let without: Vec<Row> = rows().into_iter().filter(|row| row.builder != "embree-morton").collect();
    assert_eq!(judged(&without, "phr-speed", BUILD).verdict, Verdict::NotMeasured);
    let not_grafted: Vec<Row> = rows().into_iter().filter(|row| row.kernel == "phr").collect();
    assert_eq!(judged(&not_grafted, "phr-speed", TRACE).verdict, Verdict::NotMeasured);

    let wrong = with(
        rows(),
        |row| row.builder == "phr-speed" && row.scene == "hall",
        |row| {
            (row.verified, row.error) = (Some(false), "ray 7 differs".into());
        },
    );
    assert_eq!(judged(&wrong, "phr-speed", TRACE).verdict, Verdict::Failed("hall".into()));
    let text = targets(&wrong, true);
    assert!(text.contains("not met: failed in hall"), "{text}");
    assert!(text.contains("WRONG HITS: hall phr-speed/4 under phr: ray 7 differs"), "{text}");
    // Nothing at all is still a report.
    let nothing = document(&[], false);
    assert!(nothing.contains("not measured") && nothing.contains("stopped before its end"), "{nothing}");
    assert!(!nothing.contains(" met |"), "{nothing}");
}

#[test]
fn the_report_has_a_line_for_every_target() {
    let text = targets(&rows(), true);
    let lines = text.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| builder"));
    assert_eq!(lines.count(), TARGETS.len());
    let line = text.lines().find(|line| line.starts_with("| phr-speed") && line.contains("trace")).unwrap();
    let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
    let expected = "phr-speed, trace, embree-sah, ≤ 1.00, 0.917, [0.756, 1.111], , 2.000, 1.050, yard, ≤ 1.05, 2, undecided";
    assert_eq!(cells.join(", "), expected);
    assert!(text.contains("Measured: 2026-01-02T03:04:05Z, revision 0123456789ab, threads: 2, rounds: 3."));
    let twice = |target: &Target| {
        TARGETS.iter().filter(|b| (b.builder, b.measure) == (target.builder, target.measure)).count()
    };
    assert!(TARGETS.iter().all(|target| twice(target) == 1));
}

/// Builds of growing scenes: phr-fast takes 100 ns a triangle and 1.25 as much at 32 M, embree-sah ever 200.
fn growing() -> Vec<Row> {
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

#[test]
fn growth_is_per_triangle_and_relative_to_the_smallest() {
    let rows = growing();
    let found = Growth::of(&rows);
    assert_eq!(found.sizes, [1_000_000, 4_000_000, 32_000_000]);
    let fast = found.lines.iter().find(|line| line.builder == "phr-fast").unwrap();
    assert_eq!(fast.ns, [100.0, 100.0, 125.0].map(Place::Value));
    assert_eq!(found.relative(fast, 2), Place::Value(1.25));
    let cells = |text: &str, builder: &str| {
        let line = text.lines().find(|line| line.starts_with(&format!("| {builder} "))).unwrap();
        line.split('|').map(str::trim).filter(|cell| !cell.is_empty()).collect::<Vec<_>>().join(" ")
    };
    let text = growth(&rows);
    assert_eq!(cells(&text, "phr-fast"), "phr-fast 100 1.000 1.250 ≤ 1.25 met");
    assert_eq!(cells(&text, "embree-sah"), "embree-sah 200 1.000 1.000 -");
    assert_eq!(cells(&text, "phr-speed"), "phr-speed - - - ≤ 1.25 not measured");
    let worse = with(growing(), |row| row.scene == "scalable-32M", |row| row.build_ms_median = Some(4001.0));
    assert_eq!(cells(&growth(&worse), "phr-fast"), "phr-fast 100 1.000 1.250 ≤ 1.25 not met");
    let fewer: Vec<Row> = growing().into_iter().filter(|row| row.scene != "scalable-32M").collect();
    assert_eq!(cells(&growth(&fewer), "phr-fast"), "phr-fast 100 1.000 ≤ 1.25 not measured");
    // Times of two runs are not mixed; scenes of any size are no part of the targets; others none of growth.
    let mut other = with(growing(), |_| true, |row| row.build_ms_median = Some(1.0));
    other.retain(|row| row.scene == "scalable-1M");
    other.iter_mut().for_each(|row| row.run_id = "another".into());
    other.extend(growing());
    assert_eq!(Growth::of(&other), found);
    assert_eq!(judged(&rows, "phr-fast", Measure::Build("embree-sah")).of_scenes, 0);
    assert_eq!(growth(&self::rows()), "");
}

#[test]
fn growth_is_drawn_from_two_sizes_on() {
    let draw = |rows: &[Row]| plot::figures(rows, &Under::best(rows));
    let drawings = draw(&growing());
    let drawing = drawings.iter().find(|drawing| drawing.name == "growth").unwrap();
    assert!(["phr-fast", "embree-sah"].iter().all(|name| drawing.svg.contains(&format!(">{name}<"))));
    assert_eq!(draw(&growing()), drawings);
    let one: Vec<Row> = growing().into_iter().filter(|row| row.scene == "scalable-1M").collect();
    assert!(draw(&one).iter().chain(&draw(&rows())).all(|drawing| drawing.name != "growth"));
}

#[test]
fn ablations_are_relative_to_their_base() {
    // Build, cost and EPO of speed to Morton: 0.5 in the hall, 2 in the yard.
    let text = Ablation::of(&rows(), "embree-morton", &["phr-speed", "embree-sah"]).unwrap().text();
    let lines: Vec<String> = text
        .lines()
        .filter(|line| line.starts_with("| phr-speed") || line.starts_with("| embree-sah"))
        .map(|line| {
            line.split('|').map(str::trim).filter(|cell| !cell.is_empty()).collect::<Vec<_>>().join(" ")
        })
        .collect();
    // Traces: sqrt(80 * 105) / 130, sqrt(100 * 400) / 130.
    assert_eq!(lines[0], "phr-speed 1.000 1.000 1.000 0.705 1.538");
    assert_eq!(lines[1], "embree-sah 4.000 4.000 4.000 0.769 0.769");
    assert_eq!(lines[2], "phr-speed hall 0.500 0.500 0.500 0.615 0.769");
    assert_eq!(lines[3], "phr-speed yard 2.000 2.000 2.000 0.808 3.077");
    assert_eq!(lines.len(), 6);
    let unknown = Ablation::of(&rows(), "embree-morton", &["phr-hq"]).unwrap_err();
    assert!(
        unknown.contains("phr-hq") && unknown.contains("embree-morton, embree-sah, phr-speed"),
        "{unknown}"
    );
    // A scene without a figure of the base is left out of the mean and shown as a gap.
    let gap: Vec<Row> =
        rows().into_iter().filter(|row| (&*row.builder, &*row.scene) != ("embree-morton", "yard")).collect();
    let text = Ablation::of(&gap, "embree-morton", &["phr-speed"]).unwrap().text();
    assert!(text.contains("| 0.500 |    0.500 | 0.500 | 0.615 |      0.769 |"), "{text}");
    assert!(text.lines().any(|line| line.contains("yard") && line.contains(" - ")), "{text}");
}

#[test]
fn the_commands_read_subfolders_and_say_what_is_wrong() {
    let place = tempfile::tempdir().unwrap();
    let run = place.path().join("run");
    written(&run, &rows());
    written(&run.join("growth"), &growing());
    let (code, output) = phr(&["targets", "run"], place.path());
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(code, 0, "it informs, whatever is met");
    assert_eq!(text.trim_end(), document(&[rows(), growing()].concat(), true).trim_end());
    assert!(text.contains("### Growth"), "{text}");
    let (code, older) = phr(&["bars", "run"], place.path());
    assert_eq!((code, String::from_utf8(older.stdout).unwrap()), (0, text), "the older name");

    assert_eq!(phr(&["plot", "run/growth"], place.path()).0, 0);
    assert!(run.join("growth/growth.png").is_file() && run.join("growth/growth.svg").is_file());
    assert_eq!(phr(&["plot", "run/growth", "--check"], place.path()).0, 0);

    let (code, output) = phr(&["ablation", "run", "--base", "embree-sah", "phr-speed"], place.path());
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!((code, text), (0, Ablation::of(&rows(), "embree-sah", &["phr-speed"]).unwrap().text()));

    assert_eq!(phr(&["reduce", "run", "kept"], place.path()).0, 0);
    assert_eq!(row::read(&place.path().join("kept")).unwrap(), rows());
    assert_eq!(row::read(&place.path().join("kept/growth")).unwrap(), growing());
    for arguments in [
        &["targets", "nowhere"][..],
        &["ablation", "run", "--base", "nobody", "phr-speed"],
        &["ablation", "nowhere", "--base", "embree-sah", "phr-speed"],
        &["reduce", "run", "run/kept"],
        &["reduce", "nowhere", "kept"],
        &["reduce", "run", "/proc/kept"],
    ] {
        let (code, output) = phr(arguments, place.path());
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!((code, error.lines().count()), (2, 1), "{arguments:?}: {error}");
    }
}

#[test]
fn markers_make_the_same() {
    let place = tempfile::tempdir().unwrap();
    written(&place.path().join("run"), &rows());
    written(&place.path().join("grown"), &growing());
    let made = |marker: &str| {
        let text = format!("<!-- {marker} -->\n<!-- end -->\n");
        readme::regenerate(&text, place.path()).map(|text| {
            let (_, text) = text.split_once("-->\n").unwrap();
            text.strip_suffix("\n<!-- end -->\n").unwrap().to_owned()
        })
    };
    let both = [rows(), growing()].concat();
    assert_eq!(made("targets: run").unwrap(), targets(&rows(), true).trim_end());
    assert_eq!(made("bars: run").unwrap(), made("targets: run").unwrap(), "the older name");
    assert_eq!(made("targets: run grown").unwrap(), targets(&both, true).trim_end());
    assert_eq!(made("growth: grown").unwrap(), growth(&growing()).trim_end());
    let expected = Ablation::of(&rows(), "embree-sah", &["phr-speed"]).unwrap().page();
    assert_eq!(made("ablation: run embree-sah phr-speed").unwrap(), expected.trim_end());
    let wrong = |marker: &str| made(marker).unwrap_err().to_string();
    assert!(wrong("growth: run").contains("no scalable scene"));
    assert!(wrong("targets: nowhere").contains("nowhere"));
    assert!(wrong("targets:").contains("write <!-- targets: RESULTS... -->"));
    assert!(wrong("targets: run --kernel phr").contains("write <!-- targets: RESULTS... -->"));
    assert!(wrong("ablation: run embree-sah").contains("write <!-- ablation: RESULTS BASE BUILDER... -->"));
    assert!(wrong("ablation: run embree-sah aac").contains("no builder aac"));
}
