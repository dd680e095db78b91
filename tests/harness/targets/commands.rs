//! Ablations, and the commands and markers that make all of these tables.

use super::rows::{growing, rows};
use phr::bench::row::{self, ROWS, Row};
use phr::bench::samples::SAMPLES;
use phr::report::ablation::Ablation;
use phr::report::readme;
use phr::report::targets::growth::growth;
use phr::report::targets::{document, targets};
use std::path::Path;
use std::process::{Command, Output};

fn phr(arguments: &[&str], folder: &Path) -> (i32, Output) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_phr"));
    let output = command.args(arguments).current_dir(folder).output().unwrap();
    (output.status.code().unwrap(), output)
}

fn written(folder: &Path, rows: &[Row]) {
    std::fs::create_dir_all(folder).unwrap();
    row::write(&folder.join(ROWS), rows).unwrap();
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
    std::fs::create_dir(place.path().join("other")).unwrap();
    std::fs::write(place.path().join("other").join(SAMPLES), "{}").unwrap();
    for arguments in [
        &["targets", "nowhere"][..],
        &["ablation", "run", "--base", "nobody", "phr-speed"],
        &["ablation", "nowhere", "--base", "embree-sah", "phr-speed"],
        &["reduce", "run", "run/kept"],
        &["reduce", "nowhere", "kept"],
        &["reduce", "run", "/proc/kept"],
        &["reduce", "run", "other"],
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
