//! One run against another.

use super::*;
use phr::report::compare::{Change, Outcome, Recorded};

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
fn a_run_has_no_difference_from_itself() {
    // Rounds that differ widely, told in rows over all rays alone; those of a view stand first.
    let mut rows = rows();
    for row in &mut rows {
        row.build_ms_mad = row.build_ms_median;
        if row.is_total() {
            row.by_round.build = (0..3).zip([1.0, 10.0, 2.0]).collect();
        }
    }
    let run = Recorded { rows, ..Recorded::default() };
    let outcome = Outcome::of(&run, &run, 0.05, false);
    assert!(!outcome.comparisons.is_empty());
    assert_eq!(outcome.count(Change::Same), outcome.comparisons.len(), "{}", outcome.document(0.05, false));
    let fewer: Vec<Row> = run.rows.iter().filter(|row| row.builder != "phr-hq").cloned().collect();
    let fewer = Recorded { rows: fewer, ..Recorded::default() };
    assert!(Outcome::of(&fewer, &run, 0.05, false).summary(0.05).ends_with(" only in B"));
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

/// Rows that came without their environment, as from elsewhere.
#[test]
fn a_lone_csv_is_to_tell_how_many_rows_it_has() {
    let folder = written(&rows());
    let path = folder.path().join(ROWS);
    let text = std::fs::read_to_string(&path).unwrap();
    let line = format!("# rows: {}", rows().len());
    let without = text.strip_suffix(&format!("{line}\n")).unwrap();
    std::fs::write(&path, without).unwrap();
    let verbs = [&["table", "rows.csv"][..], &["table", "."], &["compare", "rows.csv", "rows.csv"]];
    for arguments in verbs {
        let (code, output) = phr(arguments, folder.path());
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!((code, error.lines().count()), (2, 1), "{arguments:?}: {error}");
        let remedy = format!("add the line `{line}`");
        assert!(error.contains("rows.csv: no last line") && error.contains(&remedy), "{error}");
    }
    std::fs::write(&path, format!("{without}{line}\n")).unwrap();
    for arguments in verbs {
        let (code, output) = phr(arguments, folder.path());
        assert_eq!(code, 0, "{arguments:?}: {output:?}");
    }
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
