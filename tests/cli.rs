//! The command as a user meets it: what it writes, what it refuses and with which exit code.
#![cfg(feature = "harness")]

use phr::bench::environment::{ENVIRONMENT, Environment, State};
use phr::bench::files::read_json;
use phr::bench::phases::PHASES;
use phr::bench::rounds::ROUNDS;
use phr::bench::row::{self, ALL, FIRST, FRESH, REBUILD, ROWS, Row};
use phr::bench::samples::{SAMPLES, Samples};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

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
    read_json(&folder.join("out").join(ENVIRONMENT)).unwrap()
}

#[test]
fn a_run_writes_verified_rows_and_its_table() {
    let (_keep, folder) = workplace();
    let output = phr(&folder, &tiny("sheet.ply", &["--rounds", "1"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "", "silence in a pipe");

    let out = folder.join("out");
    let mut files: Vec<String> =
        std::fs::read_dir(&out).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
    files.sort();
    let drawn = ["figure6", "figure6-own", "figure6-paper", "figure6-scenes"];
    let figures: Vec<String> =
        drawn.iter().flat_map(|name| [format!("{name}.png"), format!("{name}.svg")]).collect();
    let mut expected = vec![
        ENVIRONMENT,
        ROUNDS,
        ROWS,
        SAMPLES,
        PHASES,
        "phases.png",
        "phases.svg",
        "report.html",
        "table1.md",
    ];
    if cfg!(feature = "embree") {
        expected.extend(figures.iter().map(String::as_str));
    }
    expected.sort_unstable();
    assert_eq!(files, expected);

    let told = text(&output.stdout);
    let summary = &told[told.find("## out: 1 scene").expect("a summary at the end")..];
    for part in [
        "In sheet on 2 threads",
        "Build and rays together, ",
        "table: out/table1.md",
        "rows:  out/rows.csv",
        "plots: ",
        "page:  out/report.html",
    ] {
        assert!(summary.contains(part), "no {part:?} in {summary}");
    }
    assert_eq!(summary.contains("plots: out/figure6.png"), cfg!(feature = "embree"), "{summary}");

    let rows = row::read(&out).unwrap();
    let totals: Vec<&Row> = rows.iter().filter(|row| row.is_total() && row.verified == Some(true)).collect();
    let mut seen: Vec<(&str, u32)> = totals.iter().map(|row| (row.builder.as_str(), row.width)).collect();
    seen.dedup();
    assert_eq!(seen.len(), trees(), "{seen:?}");
    for row in &rows {
        assert!(row.is_good(), "{row:?}");
        assert_eq!((row.scene.as_str(), row.triangles, row.rounds), ("sheet", 1152, 1));
        assert!(row.build_ms_median.is_some_and(|ms| ms > 0.0));
        assert!([FIRST, FRESH, REBUILD].contains(&row.regime.as_str()));
        assert_eq!(row.host, "anonymous");
    }
    for row in totals {
        assert!(row.rays.is_some_and(|rays| rays >= 256) && row.mrays_s.is_some_and(|speed| speed > 0.0));
        assert!(row.sah.is_some_and(|sah| sah > 1.0));
        let parts = rows.iter().filter(|part| {
            (&part.builder, part.width, &part.kernel) == (&row.builder, row.width, &row.kernel)
                && part.regime == FRESH
                && part.view != ALL
                && part.ray_kind != ALL
        });
        assert_eq!(parts.filter_map(|part| part.rays).sum::<u64>(), row.rays.unwrap());
    }

    let environment = environment(&folder);
    assert_eq!(environment.state, State::Complete);
    let machine = serde_json::to_string(&environment).unwrap();
    assert!(!machine.contains(folder.to_str().unwrap()), "no path of the machine in {machine}");

    let table = phr(&folder, &["table", "out"]);
    assert!(table.status.success());
    let written = std::fs::read_to_string(out.join("table1.md")).unwrap();
    assert_eq!(text(&table.stdout).trim_end(), written.trim_end());
    assert!(written.contains("| phr-fast / 4") && written.contains("sheet: 1 152 triangles"), "{written}");
}

#[test]
fn the_columns_are_documented() {
    let folder = tempfile::tempdir().unwrap();
    row::write(&folder.path().join(ROWS), &[Row::default()]).unwrap();
    let header = std::fs::read_to_string(folder.path().join(ROWS)).unwrap();
    let readme = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/README.md");
    let readme = std::fs::read_to_string(readme).unwrap();
    for column in header.lines().next().unwrap().split(',') {
        assert!(readme.contains(&format!("`{column}`")), "results/README.md does not tell of {column}");
    }
    for warning in phr::bench::warnings::Warning::ALL {
        assert!(readme.contains(&format!("`{}`", warning.name())), "nor of {warning:?}");
    }
}

#[test]
fn a_generated_scene_needs_no_file() {
    let (_keep, folder) = workplace();
    let name = phr::scene::builtin()[0].name;
    let output = phr(&folder, &tiny(name, &["--rounds", "1", "--filter", "(phr-fast|embree-sah) 4"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let rows = row::read(&folder.join("out")).unwrap();
    assert!(rows.iter().all(|row| row.scene == name && row.is_good()));
    assert!(rows.iter().all(|row| row.width == 4 && row.builder != "lbvh"));
}

#[test]
fn builds_alone_are_timed_without_rays() {
    let (_keep, folder) = workplace();
    let output = phr(&folder, &tiny("sheet.ply", &["--rounds", "3", "--build-only"]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let rows = row::read(&folder.join("out")).unwrap();
    assert_eq!(rows.len(), 3 * trees());
    assert!(rows.iter().all(|row| row.rounds == 3 && row.verified.is_none() && row.rays.is_none()));
}

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

    std::fs::write(folder.join("sheet.ply"), sheet(20)).unwrap();
    let other = phr(&folder, &tiny("sheet.ply", &["--rounds", "4", "--resume"]));
    assert_eq!(other.status.code(), Some(2));
    assert!(text(&other.stderr).contains("geometry"), "{}", text(&other.stderr));
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

#[test]
fn bad_input_is_one_line_and_code_2() {
    let (_keep, folder) = workplace();
    let whole = sheet(24);
    std::fs::write(folder.join("cut.ply"), &whole[..whole.len() / 2]).unwrap();
    std::fs::write(folder.join("empty.ply"), "").unwrap();
    std::fs::write(folder.join("none.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
    std::fs::write(folder.join("bad.obj"), "v 0 0 zero\n").unwrap();
    std::fs::write(folder.join("scene.txt"), "hello").unwrap();
    std::fs::write(folder.join("file"), "").unwrap();
    std::fs::create_dir(folder.join("folder")).unwrap();
    let generated = phr::scene::builtin()[0].name;
    let cases: &[(&[&str], &[&str])] = &[
        (&["bench", "missing.ply"], &["missing.ply", "no such file"]),
        (&["bench", "folder"], &["folder", "directory"]),
        (&["bench", "cut.ply"], &["cut.ply", "truncated"]),
        (&["bench", "sheet.ply", "cut.ply"], &["cut.ply"]),
        (&["bench", "empty.ply"], &["empty.ply"]),
        (&["bench", "none.obj"], &["none.obj"]),
        (&["bench", "bad.obj"], &["bad.obj"]),
        (&["bench", "scene.txt"], &["scene.txt", ".ply"]),
        (&["bench", "sheet.ply", "./sheet.ply"], &["two scenes", "sheet"]),
        (&["bench", "sheet.ply", "--builder", "bvh"], &["no builder is called bvh", "phr-hq"]),
        (&["bench", "sheet.ply", "--threads", "0"], &["--threads 0"]),
        (&["bench", "sheet.ply", "--threads", "2", "--one-thread"], &["--one-thread", "--build-only"]),
        (&["bench", "sheet.ply", "--threads", "99999"], &["--threads 99999"]),
        (&["bench", "sheet.ply", "--rounds", "0"], &["--rounds 0"]),
        (&["bench", "sheet.ply", "--views", "0"], &["--views 0"]),
        (&["bench", "sheet.ply", "--size", "0"], &["--size 0"]),
        (&["bench", "sheet.ply", "--filter", "("], &["--filter (", "unclosed"]),
        (&["bench", "sheet.ply", "--filter", "nothing"], &["--filter nothing", "--list"]),
        (&["bench", "sheet.ply", "--out", "file"], &["file", "--out"]),
        (&["bench", "sheet.ply", "--out", "/proc/results"], &["/proc/results", "--out"]),
        (&["bench", "sheet.ply", "--resume", "--out", "folder"], &[ENVIRONMENT, "--resume"]),
        (&["bench", "--set", "paper", "--scenes", "nowhere"], &["nowhere", "--scenes"]),
        (&["build", "missing.ply"], &["missing.ply"]),
        (&["bench", "sheet.ply", "--tree", "sheet.ply"], &["sheet.ply: not a saved tree"]),
        (&["build", "sheet.ply", "-o", "x.phrtree"], &["--output x.phrtree", "--builder"]),
        (&["build", "sheet.ply", "--builder", "lbvh", "-o", "no/x"], &["no/x", "no such folder"]),
        (&["build", "sheet.ply", "--builder", "bvh"], &["no builder is called bvh"]),
        (&["build", "sheet.ply", "--builder", "phr-hq", "--width", "5"], &["--width 5", "phr-hq"]),
        (&["build", "sheet.ply", "--threads", "0"], &["--threads 0"]),
        (&["build", "sheet.ply", "--threads", "20000"], &["--threads 20000", "1024"]),
        (&["render", "sheet.ply", "-o", "x.png", "--threads", "20000"], &["--threads 20000"]),
        (&["bench", "sheet.ply", "--name", "../../x"], &["--name ../../x"]),
        (&["bench", "sheet.ply", "--name", ".."], &["--name .."]),
        (&["bench", "sheet.ply", "--host", "=cmd"], &["--host =cmd"]),
        (&["build", "sheet.ply", "--max-memory", "1k"], &["sheet.ply", "--max-memory"]),
        (&["render", generated, "-o", "x.png", "--view", "99"], &["--view 99", generated]),
        (&["render", "sheet.ply", "-o", "nowhere/x.png"], &["nowhere", "folder"]),
        (&["render", "sheet.ply", "-o", "folder"], &["folder", "directory"]),
        (&["render", "sheet.ply", "-o", "x.png", "--size", "0"], &["--size 0"]),
        (&["verify", "missing.ply"], &["missing.ply"]),
        (&["verify", "sheet.ply", "--builder", "bvh"], &["no builder is called bvh"]),
        (&["table", "nowhere"], &["nowhere", "phr bench"]),
        (&["report", "nowhere"], &["nowhere", "phr bench"]),
        (&["report", "folder"], &[ROWS, "phr bench"]),
        (&["table", "folder"], &[ROWS, "phr bench"]),
        (&["table", "sheet.ply"], &["sheet.ply"]),
    ];
    for (arguments, wanted) in cases {
        let output = phr(&folder, arguments);
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
        assert_eq!(told.lines().count(), 1, "{arguments:?}: {told}");
        assert!(!told.contains("panicked") && told.starts_with("phr: "), "{arguments:?}: {told}");
        for part in *wanted {
            assert!(told.contains(part), "{arguments:?}: no {part:?} in {told}");
        }
        assert_eq!(text(&output.stdout), "", "{arguments:?}");
    }
    assert!(!folder.join("results").exists(), "a refused run writes nothing");
    assert_eq!(phr(&folder, &["bench", "--no-such-option"]).status.code(), Some(2));
    assert_eq!(phr(&folder, &[]).status.code(), Some(2));
}

#[test]
fn listing_and_dry_runs_touch_nothing() {
    let (_keep, folder) = workplace();
    let list = phr(&folder, &["bench", "sheet.ply", "--list", "--builder", "phr-hq"]);
    assert!(text(&list.stdout).lines().any(|line| line == "sheet phr-hq 4 phr"), "{}", text(&list.stdout));
    let dry = phr(&folder, &tiny("sheet.ply", &["--dry-run"]));
    assert!(dry.status.success() && text(&dry.stdout).contains("visits"), "{}", text(&dry.stdout));
    assert!(!folder.join("out").exists() && !folder.join("results").exists());
    let scenes = phr(&folder, &["scenes"]);
    assert!(text(&scenes.stdout).contains(phr::scene::builtin()[0].name));
}

#[test]
fn single_verbs_do_their_work() {
    let (_keep, folder) = workplace();
    let build = phr(&folder, &["build", "sheet.ply", "--builder", "phr-hq"]);
    let told = text(&build.stdout);
    assert!(build.status.success() && told.contains("SAH cost") && told.contains("1152 triangles"), "{told}");

    let build =
        phr(&folder, &["build", "sheet.ply", "--builder", "phr-hq", "--width", "8", "-o", "x.phrtree"]);
    assert!(build.status.success(), "{}", text(&build.stderr));
    let scene = phr::scene::load(&folder.join("sheet.ply")).unwrap();
    let saved = phr::bvh::Bvh8::load(&scene.mesh, &folder.join("x.phrtree")).unwrap();
    assert_eq!(saved.validate(&scene.mesh), Ok(()));
    let bench = phr(&folder, &tiny("sheet.ply", &["--rounds", "1", "--tree", "x.phrtree"]));
    assert!(bench.status.success(), "{}", text(&bench.stderr));
    let rows = row::read(&folder.join("out")).unwrap();
    let loaded: Vec<&Row> = rows.iter().filter(|row| row.builder == "saved:x" && row.is_total()).collect();
    assert!(loaded.iter().any(|row| row.verified == Some(true)), "{loaded:?}");
    assert!(
        loaded.iter().all(|row| row.width == 8 && row.is_good() && row.builder_config.contains("phr-hq"))
    );
    let generated = phr::scene::builtin()[0].name;
    let other = phr(&folder, &["bench", generated, "--tree", "x.phrtree"]);
    assert_eq!(other.status.code(), Some(2));
    assert!(
        text(&other.stderr).contains("the tree of another mesh (1152 triangles"),
        "{}",
        text(&other.stderr)
    );

    let render = phr(&folder, &["render", "sheet.ply", "-o", "x.png", "--size", "16", "--samples", "2"]);
    assert!(render.status.success(), "{}", text(&render.stderr));
    assert!(std::fs::read(folder.join("x.png")).unwrap().starts_with(b"\x89PNG"));

    let verify = phr(&folder, &["verify", "sheet.ply", "--size", "32"]);
    let told = text(&verify.stdout);
    assert!(verify.status.success() && told.contains("verified") && !told.contains("WRONG"), "{told}");
}

#[test]
fn an_unknown_instruction_set_is_refused() {
    let (_guard, folder) = workplace();
    let output = command(&folder, &["scenes"]).env("PHR_ISA", "avx3").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("PHR_ISA=avx3 names no instruction set"),
        "{}",
        text(&output.stderr)
    );
}

#[test]
fn two_programs_are_measured_by_turns() {
    let (_place, folder) = workplace();
    let this = env!("CARGO_BIN_EXE_phr");
    let compare = |program: &str, more: &[&str]| {
        let arguments = ["compare", "--against", program, "sheet.ply", "--builder", "lbvh", "--seconds", "1"];
        phr(&folder, &[&arguments[..], more].concat())
    };
    let output = compare(this, &["--threads", "1"]);
    let table = text(&output.stdout);
    // What it decides depends on the machine.
    assert!(matches!(output.status.code(), Some(0 | 1 | 3)), "{}", text(&output.stderr));
    assert_eq!(table.lines().filter(|line| line.starts_with("| lbvh / 4 ")).count(), 2, "{table}");
    assert!(table.contains("1 builders: ") && table.contains(" sessions of fresh processes"), "{table}");
    for (program, more) in
        [("/bin/true", &[][..]), ("/no/such/program", &[]), (this, &["--builder", "nobody"])]
    {
        let output = compare(program, more);
        assert_eq!((output.status.code(), text(&output.stderr).lines().count()), (Some(2), 1), "{program}");
    }
    assert_eq!(phr(&folder, &["compare", "one"]).status.code(), Some(2));
}
