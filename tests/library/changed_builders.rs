//! Builders changed on the command line and from a file: their names in the rows, and what is refused.
#![cfg(feature = "harness")]

use phr::bench::row::{self, Row};
use std::path::Path;
use std::process::{Command, Output};

fn phr(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_phr")).current_dir(folder).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

const TINY: [&str; 11] =
    ["bench", "scalable-2k", "--size", "16", "--views", "1", "--rounds", "1", "--threads", "2", "--out=out"];

#[test]
fn rows_carry_the_name_and_the_configuration_of_a_changed_builder() {
    let folder = tempfile::tempdir().unwrap();
    let file =
        r#"{"name": "mine", "base": "phr-speed", "width": 8, "fields": {"presplit": null, "max_cut": 64}}"#;
    std::fs::write(folder.path().join("mine.json"), file).unwrap();
    let changes = [
        "--builder",
        "phr-hq",
        "--set",
        "phr-hq.delta=8",
        "--set",
        "phr-hq.filled=0.25",
        "--config",
        "mine.json",
    ];
    let output = phr(folder.path(), &[&TINY[..], &changes].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));

    let rows = row::read(&folder.path().join("out")).unwrap();
    let mut names: Vec<(&str, u32)> = rows.iter().map(|row| (row.builder.as_str(), row.width)).collect();
    names.dedup();
    let changed = "phr-hq[delta=8+presplit.filled=0.25]";
    assert_eq!(names, [("phr-hq", 4), ("phr-hq", 8), (changed, 4), (changed, 8), ("mine", 8)]);
    assert!(rows.iter().all(Row::is_good));
    let config = |name: &str| -> serde_json::Value {
        serde_json::from_str(&rows.iter().find(|row| row.builder == name).unwrap().builder_config).unwrap()
    };
    assert_eq!(
        (config("phr-hq")["delta"].as_f64(), config(changed)["delta"].as_f64()),
        (Some(9.0), Some(8.0))
    );
    assert_eq!(config(changed)["presplit"]["filled"], 0.25);
    assert_eq!(
        (&config("mine")["presplit"], &config("mine")["max_cut"]),
        (&serde_json::Value::Null, &64.into())
    );
    let memory = rows.iter().filter(|row| row.builder == "mine" && row.is_total());
    assert!(
        memory.into_iter().all(|row| row.peak_bytes.is_some_and(|bytes| bytes > 0)),
        "its own process builds it too"
    );
    std::fs::write(folder.path().join("mine.json"), r#"{"name": "mine", "base": "phr-speed", "width": 8}"#)
        .unwrap();
    let output = phr(folder.path(), &[&TINY[..], &["--config", "mine.json", "--resume"]].concat());
    assert!(
        text(&output.stderr).contains("made with another configuration called mine"),
        "{}",
        text(&output.stderr)
    );
    let table = std::fs::read_to_string(folder.path().join("out/table1.md")).unwrap();
    assert!(table.contains(changed), "{table}");
}

#[test]
fn every_verb_takes_changed_builders() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["build", "scalable-2k", "--set", "phr-hq.delta=8"][..],
        &["verify", "scalable-2k", "--size", "16", "--set", "phr-hq.delta=8"],
        &[
            "render",
            "scalable-2k",
            "--size",
            "16",
            "--builder",
            "phr-hq",
            "--set",
            "phr-hq.delta=8",
            "-o",
            "a.png",
        ],
    ] {
        let output = phr(folder.path(), arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        assert!(text(&output.stdout).contains("phr-hq[delta=8]"), "{}", text(&output.stdout));
        assert!(!text(&output.stdout).contains("lbvh"), "no other builder was asked for");
    }
}

#[test]
fn what_cannot_be_set_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for (change, reason) in [
        ("phr-hq.gamma=1", "its fields are alpha, "),
        ("phr-hq.delta=x", "expected f32"),
        ("phr-hq.delta=99", "give 0.0 to 64.0"),
        ("phr.delta=9", "there are lbvh, "),
        ("embree-sah.delta=9", "no builder of ours"),
        ("phr-hq", "BUILDER.FIELD=VALUE"),
    ] {
        let output = phr(folder.path(), &[&TINY[..], &["--set", change]].concat());
        let told = text(&output.stderr);
        assert_eq!((output.status.code(), told.lines().count()), (Some(2), 1), "{change}: {told}");
        assert!(told.contains(reason), "{change}: {told}");
    }
    let output = phr(folder.path(), &[&TINY[..], &["--config", "nowhere.json"]].concat());
    assert!(text(&output.stderr).contains("nowhere.json: "), "{}", text(&output.stderr));
    assert!(!folder.path().join("out").exists());
}
