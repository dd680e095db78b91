//! The figures of the documentation are those of the committed rows, and the committed plots are drawn from them.

#![cfg(feature = "harness")]

use std::process::Command;

fn phr(arguments: &[&str]) {
    let output = Command::new(env!("CARGO_BIN_EXE_phr"))
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "phr {}: {}{}",
        arguments.join(" "),
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn figures_in_the_text_are_those_of_the_rows() {
    phr(&["readme", "--check", "README.md", "RESULTS.md"]);
}

#[test]
fn the_readme_is_short() {
    let lines = include_str!("../README.md").lines().count();
    assert!(
        lines <= 130,
        "README.md has {lines} lines, at most 130 are wanted; move details to another page"
    );
}

#[test]
fn plots_are_drawn_from_the_rows() {
    for folder in ["results/reference", "results/reference/growth"] {
        phr(&["plot", folder, "--check"]);
    }
}

#[test]
fn the_table_beside_the_rows_is_theirs() {
    let output = Command::new(env!("CARGO_BIN_EXE_phr"))
        .args(["table", "results/reference"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let committed = std::fs::read_to_string("results/reference/table1.md").unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim_end(), committed.trim_end());
}
