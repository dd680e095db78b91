//! A run spread over shards and merged is the run: the same rows but for times.
use phr::bench::environment::{ENVIRONMENT, Environment};
use phr::bench::files::{read_json, write_json};
use phr::bench::row::{self, Row};
use std::path::Path;
use std::process::{Command, Output};

const SCENES: [&str; 3] = ["a.ply", "b.ply", "c.ply"];

fn phr(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_phr")).current_dir(folder).args(arguments).output().unwrap()
}

fn bench(folder: &Path, more: &[&str]) -> Output {
    for (n, scene) in (10..).zip(SCENES) {
        std::fs::write(folder.join(scene), strip(n)).unwrap();
    }
    let builds =
        ["--build-only", "--builder", "lbvh", "--builder", "phr-fast", "--rounds", "2", "--threads", "1"];
    phr(folder, &[&["bench"], &SCENES[..], &builds, more].concat())
}

/// A strip of `2 * n` triangles, as PLY.
fn strip(n: usize) -> String {
    let vertices: String = (0..=n).map(|i| format!("{i} 0 {}\n{i} 1 0\n", i % 3)).collect();
    let faces = (0..n).map(|i| format!("4 {} {} {} {}\n", 2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2));
    format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {n}\nproperty list uchar int vertex_indices\nend_header\n{vertices}{}",
        2 * n + 2,
        faces.collect::<String>()
    )
}

/// A merged folder with its shards, and that of the same run in one.
fn measured(folder: &Path) {
    for shard in ["2/2", "1/2"] {
        let output = bench(folder, &["--shard", shard, "--out", "apart"]);
        assert!(output.status.success(), "{output:?}");
    }
    assert!(bench(folder, &["--out", "whole"]).status.success());
}

/// What of a row does not depend on the moment.
fn lasting(rows: &[Row]) -> Vec<String> {
    let of = |row: &Row| {
        let tree =
            (&row.builder, row.width, &row.builder_config, row.sah, row.nodes, row.leaves, row.refs_per_tri);
        format!("{} {} {} {tree:?} {} {}", row.scene, row.scene_sha, row.triangles, row.regime, row.rounds)
    };
    rows.iter().map(of).collect()
}

fn refused(folder: &Path) -> String {
    let output = phr(folder, &["merge", "apart"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn merged_shards_are_the_whole_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    measured(folder);
    let shards = [folder.join("apart/shards/1-of-2"), folder.join("apart/shards/2-of-2")];
    let scenes = |path: &Path| {
        let mut scenes: Vec<String> = row::read(path).unwrap().into_iter().map(|row| row.scene).collect();
        scenes.dedup();
        scenes
    };
    assert_eq!((scenes(&shards[0]), scenes(&shards[1])), (vec!["a".into(), "c".into()], vec!["b".into()]));
    let output = phr(folder, &["merge", "apart"]);
    assert!(output.status.success(), "{output:?}");
    let [merged, whole] = ["apart", "whole"].map(|name| lasting(&row::read(&folder.join(name)).unwrap()));
    assert_eq!(merged, whole);
    assert!(folder.join("apart/table1.md").is_file());
    let environment: Environment = read_json(&folder.join("apart").join(ENVIRONMENT), "").unwrap();
    assert_eq!(environment.plan["scenes"].as_array().unwrap().len(), 3);
    assert_eq!(environment.before.len(), 2, "a moment of each shard");

    // Unlike machines are kept apart.
    let path = shards[1].join(ENVIRONMENT);
    let mut other: Environment = read_json(&path, "").unwrap();
    other.machine.cpu = "another".into();
    write_json(&path, &other).unwrap();
    let output = phr(folder, &["merge", "apart"]);
    assert!(String::from_utf8(output.stdout).unwrap().contains("phr compare"), "unlike machines are told");
    assert_eq!(scenes(&folder.join("apart/machines/1")), ["a", "c"]);
    assert_eq!(scenes(&folder.join("apart/machines/2")), ["b"]);

    // What does not belong together is refused.
    other.plan["settings"]["rounds"] = 9.into();
    write_json(&path, &other).unwrap();
    assert!(refused(folder).contains("another plan"));
    std::fs::remove_dir_all(&shards[1]).unwrap();
    assert!(refused(folder).contains("no shard has b"));
    std::fs::remove_file(shards[0].join(ENVIRONMENT), "").unwrap();
    assert!(refused(folder).contains("not finished"));
    std::fs::remove_dir_all(&shards[0]).unwrap();
    assert!(refused(folder).contains("no shards"));
}

#[test]
fn shards_that_cannot_be_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (shard, reason) in [("4/3", "as 2/3"), ("0/3", "as 2/3"), ("4/4", "give 3 or fewer")] {
        let output = bench(folder.path(), &["--shard", shard]);
        assert_eq!(output.status.code(), Some(2));
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains(reason), "{message}");
    }
}
