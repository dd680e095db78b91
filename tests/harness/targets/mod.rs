//! Targets, growth and ablations from rows made by hand, every figure worked out beside.

mod commands;
mod growth;
mod rows;

use phr::bench::row::Row;
use phr::report::targets::judge::{Judge, Judged, Verdict};
use phr::report::targets::list::{self, Measure, Target};
use phr::report::targets::{document, targets};
use rows::{row, rows, with};

fn judged(rows: &[Row], builder: &str, measure: Measure) -> Judged {
    let (mean, worst) = match (builder, measure) {
        ("phr-speed", BUILD) => (Some(1.0), None),
        ("phr-speed", TRACE) => (Some(1.0), Some(1.05)),
        ("phr-speed", Measure::Peak) => (None, Some(110.0)),
        ("phr-speed", Measure::PeakTo(_)) => (Some(0.8), None),
        ("phr-speed", Measure::Tree) => (None, Some(64.0)),
        ("phr-speed", Measure::Threads) => (Some(1.85), None),
        ("phr-best", _) => (Some(0.6), None),
        _ => (None, None),
    };
    let builder = list::targets().iter().map(|target| target.builder).find(|name| *name == builder).unwrap();
    Judge::new(rows).judge(&Target { builder, width: 4, measure, mean, worst })
}

fn near(value: Option<f64>, expected: f64) -> bool {
    value.is_some_and(|value| (value - expected).abs() < 1e-9)
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
    // Both scenes twice or neither: the ends are 0.5 and 2, deviations enlarged by sqrt(2 / 1) and by Student's factor
    // of one degree of freedom.
    let interval = build.interval.unwrap();
    let end = 2f64.powf(2f64.sqrt() * 12.706 / 1.96);
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

/// The scene of the largest ratio is within the limit, but noise in the other reaches over it.
#[test]
fn every_scene_is_held_to_the_limit_of_the_worst() {
    let quiet = judged(&alike(9.0), "phr-speed", TRACE);
    assert_eq!((quiet.may_exceed, &quiet.verdict), (0, &Verdict::Met));
    let noisy = with(
        alike(9.0),
        |row| row.builder == "phr-speed" && row.scene == "yard",
        |row| (row.trace_ms_median, row.trace_ms_mad) = (Some(85.0), Some(20.0)),
    );
    let trace = judged(&noisy, "phr-speed", TRACE);
    assert_eq!(worst(&trace), Some(("hall", 0.9)), "{trace:?}");
    assert_eq!((trace.may_exceed, &trace.verdict), (1, &Verdict::Undecided));
}

#[test]
fn bytes_are_of_large_scenes() {
    let small = with(rows(), |row| row.scene == "yard", |row| row.triangles = 1_000_000);
    let peak = judged(&small, "phr-speed", Measure::Peak);
    assert!(near(peak.mean, 110.0), "{peak:?}");
    assert_eq!((peak.scenes, &peak.verdict), (1, &Verdict::Met));
    let to_morton = judged(&small, "phr-speed", Measure::PeakTo("embree-morton"));
    assert!(to_morton.scenes == 1 && to_morton.interval.is_some(), "{to_morton:?}");
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

    // A kernel that cannot be had is no failure, and a mean without a scene is not sure.
    let unavailable = with(
        alike(9.0),
        |row| row.kernel == "embree-grafted",
        |row| (row.trace_ms_median, row.error) = (None, "not available, because of another layout".into()),
    );
    assert_eq!(judged(&unavailable, "phr-speed", TRACE).verdict, Verdict::NotMeasured);
    let one_lacks: Vec<Row> = alike(9.0)
        .into_iter()
        .filter(|row| (row.scene.as_str(), row.builder.as_str()) != ("hall", "phr-speed"))
        .collect();
    let build = judged(&one_lacks, "phr-speed", BUILD);
    assert_eq!((build.scenes, build.of_scenes, build.verdict), (1, 2, Verdict::Undecided));

    // What failed in a run is not made good by another.
    let failed = |row: &Row| row.builder == "phr-speed" && row.scene == "hall";
    let no_build = |row: &mut Row| (row.build_ms_median, row.error) = (None, "it panicked".into());
    let mut twice = with(alike(9.0), failed, no_build);
    assert_eq!(judged(&twice, "phr-speed", BUILD).verdict, Verdict::Failed("hall".into()));
    let another = alike(9.0).into_iter().filter(|row| failed(row) && row.kernel == "embree-grafted");
    twice.extend(another.map(|row| Row { run_id: "another".into(), kernel: "none".into(), ..row }));
    assert_eq!(judged(&twice, "phr-speed", BUILD).verdict, Verdict::Failed("hall".into()));

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
    let lines = lines.filter(|line| !line.starts_with("| compared with") && !line.starts_with("| trees of "));
    assert_eq!(lines.count(), list::targets().len());
    let line = text.lines().find(|line| line.starts_with("| phr-speed") && line.contains("trace")).unwrap();
    let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
    let expected = "phr-speed, 4, trace, embree-sah, ≤ 0.86, 0.917, [0.264, 3.188], , 2.000, 1.050, yard, ≤ 1.00, 1, 2, not met";
    assert_eq!(cells.join(", "), expected);
    assert!(text.contains("Measured: 2026-01-02T03:04:05Z, revision 0123456789ab, threads: 2, rounds: 3."));
    let twice = |target: &Target| {
        let same = |other: &&Target| {
            (other.builder, other.width, other.measure) == (target.builder, target.width, target.measure)
        };
        list::targets().iter().filter(same).count()
    };
    assert!(list::targets().iter().all(|target| twice(target) == 1));
}
