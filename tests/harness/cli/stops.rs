//! Runs that are stopped, killed and resumed.

use super::*;
use phr::bench::environment::State;
use phr::bench::row::{self, ROWS};
use phr::bench::samples::Samples;
use std::process::Stdio;
use std::time::{Duration, Instant};

#[test]
fn a_run_goes_on_where_it_stopped() {
    let (_keep, folder) = workplace();
    assert!(phr(&folder, &tiny("sheet.ply", &["--rounds", "1"])).status.success());
    let first = Samples::read(&folder.join("out")).unwrap();
    let output = phr(&folder, &tiny("sheet.ply", &["--rounds", "3", "--resume"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let both = Samples::read(&folder.join("out")).unwrap();
    assert_eq!(both.run_id, first.run_id);
    for (before, after) in first.scenes[0].cells.iter().zip(&both.scenes[0].cells) {
        assert_eq!(after.visits.len(), 3);
        assert_eq!(after.visits[0], before.visits[0], "a finished visit is not made again");
    }
    let other = phr(&folder, &tiny("sheet.ply", &["--resume", "--seed", "9"]));
    assert_eq!(other.status.code(), Some(2));
    assert!(text(&other.stderr).contains("seed"), "{}", text(&other.stderr));

    // What is refused leaves the run as it is.
    let known = std::fs::read(folder.join("out").join(ENVIRONMENT)).unwrap();
    let refused = |more: &[&str], why: &str| {
        let other = phr(&folder, &tiny("sheet.ply", &[&["--rounds", "4", "--resume"], more].concat()));
        assert_eq!(other.status.code(), Some(2));
        assert!(text(&other.stderr).contains(why), "{}", text(&other.stderr));
        assert_eq!(std::fs::read(folder.join("out").join(ENVIRONMENT)).unwrap(), known, "{why}");
    };
    refused(&["--filter", "phr$"], "set of kernels");
    let path = folder.join("out").join(ENVIRONMENT);
    let elsewhere = text(&known).replacen("\"processors\": ", "\"processors\": 9", 1);
    std::fs::write(&path, &elsewhere).unwrap();
    let other = phr(&folder, &tiny("sheet.ply", &["--rounds", "4", "--resume"]));
    assert!(text(&other.stderr).contains("number of processors"), "{}", text(&other.stderr));
    std::fs::write(&path, &known).unwrap();
    std::fs::write(folder.join("sheet.ply"), sheet(20)).unwrap();
    refused(&[], "geometry of sheet");
}

/// A run stopped in one of two scenes is not complete by resuming the other.
#[test]
fn scenes_that_are_not_resumed_stay_unfinished() {
    let (_keep, folder) = workplace();
    std::fs::copy(folder.join("sheet.ply"), folder.join("other.ply")).unwrap();
    let run = |more: &[&str]| {
        let output = phr(&folder, &tiny("sheet.ply", &[&["--rounds", "1"], more].concat()));
        assert!(output.status.success(), "{}", text(&output.stderr));
        (environment(&folder).state, environment(&folder).plan["scenes"].as_array().unwrap().len())
    };
    assert_eq!(run(&["other.ply"]), (State::Complete, 2));
    assert_eq!(run(&["--resume"]), (State::Complete, 1), "nothing was left");
    assert_eq!(run(&["other.ply", "--resume"]), (State::Complete, 2));
    let path = folder.join("out").join(ENVIRONMENT);
    let stopped = std::fs::read_to_string(&path).unwrap().replacen("\"complete\"", "\"interrupted\"", 1);
    std::fs::write(&path, stopped).unwrap();
    assert_eq!(run(&["--resume"]), (State::Interrupted, 2));
    assert_eq!(run(&["other.ply", "--resume"]), (State::Complete, 2));
}

/// The time spent in a scene counts over all sessions, and what it was too short for is told by each.
#[test]
fn time_goes_on_where_a_run_stopped() {
    let (_keep, folder) = workplace();
    let visits = || Samples::read(&folder.join("out")).unwrap().scenes[0].cells[0].visits.len();
    assert!(phr(&folder, &tiny("sheet.ply", &["--rounds", "2"])).status.success());
    // Longer than two rounds take on any machine.
    let until = ["--rounds", "2", "--seconds", "1", "--until", "0.1%", "--limit", "5", "--resume"];
    assert!(phr(&folder, &tiny("sheet.ply", &until)).status.success());
    let (all, notes) = (visits(), environment(&folder).notes);
    assert!(all > 2 && notes.iter().any(|note| note.starts_with("sheet: intervals ")), "{notes:?}");
    assert!(phr(&folder, &tiny("sheet.ply", &until)).status.success());
    assert_eq!((visits(), environment(&folder).notes), (all, notes), "the time was over");
}

/// Starts a run that would last for ever, and stops it with `signal` once rows are on disk.
fn stopped_by(signal: &str, folder: &Path) -> Option<i32> {
    let mut command = command(folder, &tiny("sheet.ply", &["--rounds", "60000"]));
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while !folder.join("out").join(ROWS).exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no row after a minute");
        std::thread::sleep(Duration::from_millis(20));
    }
    let killed = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    child.wait().unwrap().code()
}

#[test]
#[cfg(unix)]
fn ctrl_c_keeps_what_is_finished_and_says_so() {
    let (_keep, folder) = workplace();
    assert_eq!(stopped_by("-INT", &folder), Some(130));
    let rows = row::read(&folder.join("out")).unwrap();
    assert!(rows.iter().all(|row| row.warnings.contains("Unfinished")));
    assert_eq!(environment(&folder).state, State::Interrupted);
    let table = text(&phr(&folder, &["table", "out"]).stdout);
    assert!(table.contains("Part of a run"), "{table}");
    let resumed = phr(&folder, &tiny("sheet.ply", &["--rounds", "1", "--resume"]));
    assert!(resumed.status.success(), "{}", text(&resumed.stderr));
    assert_eq!(environment(&folder).state, State::Complete);
}

#[test]
#[cfg(unix)]
fn a_kill_loses_no_finished_row() {
    let (_keep, folder) = workplace();
    assert_eq!(stopped_by("-KILL", &folder), None);
    assert!(!row::read(&folder.join("out")).unwrap().is_empty());
    assert_eq!(environment(&folder).state, State::Running);
    let resumed = phr(&folder, &tiny("sheet.ply", &["--rounds", "1", "--resume"]));
    assert!(resumed.status.success(), "{}", text(&resumed.stderr));
}
