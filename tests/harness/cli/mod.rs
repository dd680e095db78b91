//! The command as a user meets it: what it writes, what it refuses and with which exit code.
mod runs;
mod stops;
mod verbs;

use phr::bench::environment::{ENVIRONMENT, Environment};
use phr::bench::files::read_json;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const BUILDERS: [&str; 2] = ["lbvh", "phr-fast"];

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_phr"));
    command.current_dir(folder).args(arguments);
    command
}

fn phr(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A folder with a small scene: a bumpy sheet over a floor, as ASCII PLY.
fn workplace() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sheet.ply"), sheet(24)).unwrap();
    let path = folder.path().to_owned();
    (folder, path)
}

fn sheet(n: usize) -> String {
    let mut vertices = String::new();
    let mut faces = String::new();
    for y in 0..=n {
        for x in 0..=n {
            let height = ((x * 7 + y * 13) % 11) as f32 * 0.1;
            vertices += &format!("{x} {y} {height}\n");
        }
    }
    for y in 0..n {
        for x in 0..n {
            let corner = y * (n + 1) + x;
            faces += &format!("4 {} {} {} {}\n", corner, corner + 1, corner + n + 2, corner + n + 1);
        }
    }
    let (vertex_count, face_count) = ((n + 1) * (n + 1), n * n);
    format!(
        "ply\nformat ascii 1.0\nelement vertex {vertex_count}\nproperty float x\nproperty float y\n\
         property float z\nelement face {face_count}\nproperty list uchar int vertex_indices\nend_header\n\
         {vertices}{faces}"
    )
}

/// Arguments of a run that takes no time.
fn tiny<'a>(scene: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments =
        vec!["bench", scene, "--size", "16", "--views", "1", "--threads", "2", "--out", "out"];
    for builder in BUILDERS {
        arguments.extend(["--builder", builder]);
    }
    if cfg!(feature = "embree") {
        arguments.extend(["--builder", "embree-sah"]);
    }
    arguments.extend(more);
    arguments
}

fn trees() -> usize {
    2 * (BUILDERS.len() + usize::from(cfg!(feature = "embree")))
}

fn environment(folder: &Path) -> Environment {
    read_json(&folder.join("out").join(ENVIRONMENT), "").unwrap()
}
