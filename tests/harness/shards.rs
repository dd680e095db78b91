//! A run spread over shards and merged is the run: the same rows but for times.
use phr::bench::environment::{ENVIRONMENT, Environment, State};
use phr::bench::files::{read_json, write_json};
use phr::bench::row::{self, Row};
use phr::report::figures::{Figure, Under};
use phr::report::means::Ratios;
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

fn scenes(folder: &Path) -> Vec<String> {
    let mut scenes: Vec<String> = row::read(folder).unwrap().into_iter().map(|row| row.scene).collect();
    scenes.dedup();
    scenes
}

#[test]
fn merged_shards_are_the_whole_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    measured(folder);
    let shards = [folder.join("apart/shards/1-of-2"), folder.join("apart/shards/2-of-2")];
    assert_eq!((scenes(&shards[0]), scenes(&shards[1])), (vec!["a".into(), "c".into()], vec!["b".into()]));
    let output = phr(folder, &["merge", "apart"]);
    assert!(output.status.success(), "{output:?}");
    let [merged, whole] = ["apart", "whole"].map(|name| lasting(&row::read(&folder.join(name)).unwrap()));
    assert_eq!(merged, whole);
    assert!(folder.join("apart/table1.md").is_file());
    let environment: Environment = read_json(&folder.join("apart").join(ENVIRONMENT), "").unwrap();
    assert_eq!(environment.plan["scenes"].as_array().unwrap().len(), 3);
    let [first, second] = &environment.before[..] else { panic!("a moment of each shard") };
    assert!(first.utc <= second.utc, "in the order of time, though the second shard was measured first");
    let page = std::fs::read_to_string(folder.join("apart/report.html")).unwrap();
    assert!(page.contains("2 shards on machines of this kind"));

    // What does not belong together is refused, and nothing is lost by that.
    let path = shards[1].join(ENVIRONMENT);
    let mine: Environment = read_json(&path, "").unwrap();
    let mut other = mine.clone();
    other.plan["settings"]["rounds"] = 9.into();
    write_json(&path, &other).unwrap();
    assert!(refused(folder).contains("another plan"));
    let alone = ["--shard", "2/2", "--out", "apart", "--replace", "--width", "4"];
    assert!(bench(folder, &alone).status.success());
    assert!(refused(folder).contains("another set of builders"));
    write_json(&path, &Environment { state: State::Interrupted, ..mine }).unwrap();
    assert!(refused(folder).contains("--resume"));
    std::fs::write(folder.join("apart/samples.json"), "{}").unwrap();
    assert!(refused(folder).contains("apart/shards/2-of-2: not finished"));
    assert_eq!(lasting(&row::read(&folder.join("apart")).unwrap()), whole);
    std::fs::remove_dir_all(&shards[1]).unwrap();
    assert!(refused(folder).contains("holds a run of its own"));
    std::fs::remove_file(folder.join("apart/samples.json")).unwrap();
    assert!(refused(folder).contains("no shard has b"));
    std::fs::remove_file(shards[0].join(ENVIRONMENT)).unwrap();
    assert!(refused(folder).contains("--replace"), "without its environment it cannot be resumed");
    std::fs::remove_dir_all(&shards[0]).unwrap();
    assert!(refused(folder).contains("no shards"));
}

#[test]
fn unlike_machines_are_compared_and_not_averaged() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    measured(folder);
    let apart = folder.join("apart");
    let merged = || {
        let output = phr(folder, &["merge", "apart"]);
        assert!(output.status.success(), "{output:?}");
        let files = std::fs::read_dir(&apart).unwrap().map(|file| file.unwrap().file_name());
        let mut files: Vec<String> = files.map(|name| name.into_string().unwrap()).collect();
        files.sort();
        (String::from_utf8(output.stdout).unwrap(), files)
    };
    let (_, alike) = merged();
    let path = apart.join("shards/2-of-2").join(ENVIRONMENT);
    let mine: Environment = read_json(&path, "").unwrap();
    let mut other = mine.clone();
    other.machine.cpu = "another".into();
    write_json(&path, &other).unwrap();
    let (told, files) = merged();
    assert_eq!(files, ["machines", "shards"], "nothing is left of the run that was merged of them");

    let machines = ["1", "2"].map(|number| apart.join("machines").join(number));
    assert_eq!(
        (scenes(&machines[0]), scenes(&machines[1])),
        (vec!["a".into(), "c".into()], vec!["b".into()])
    );
    let compared = std::fs::read_to_string(apart.join("machines/compared.md")).unwrap();
    assert!(told.contains(compared.trim_end()), "{told}");
    let line = |start: &str| {
        let found = compared.lines().find(|line| line.starts_with(start));
        found.unwrap_or_else(|| panic!("no {start} in {compared}"))
    };
    assert!(line("* machine 1: ").ends_with(": a, c") && line("* machine 2: another, ").ends_with(": b"));
    let of_tree: Vec<&str> = line("| phr-fast ").split('|').map(str::trim).collect();
    for (machine, shown) in machines.iter().zip(&of_tree[2..]) {
        let rows = row::read(machine).unwrap();
        let ratios = Ratios::to(("lbvh", 4), &rows, ("phr-fast", 4), Figure::Build, &Under::Own);
        assert!(shown.starts_with(&format!("{:.2} [", ratios.geometric().unwrap())), "{compared}");
    }

    write_json(&path, &mine).unwrap();
    assert_eq!(merged().1, alike, "nor of the machines, when they are alike again");
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
