//! What is refused, and the verbs beside the bench.

use super::*;
use phr::bench::row::{self, ROWS, Row};
use phr::bench::turns::row as turns;

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
        (&["bench", "sheet.ply", "--until", "200%"], &["200%", "below 100"]),
        (&["bench", "sheet.ply", "--views", "0"], &["--views 0"]),
        (&["bench", "sheet.ply", "--size", "0"], &["--size 0"]),
        (&["bench", "sheet.ply", "--filter", "("], &["--filter (", "unclosed"]),
        (&["bench", "sheet.ply", "--filter", "nothing"], &["--filter nothing", "--list"]),
        (&["bench", "sheet.ply", "--out", "file"], &["file", "--out"]),
        (&["bench", "sheet.ply", "--out", "/proc/results"], &["/proc/results", "--out"]),
        (&["bench", "sheet.ply", "--resume", "--out", "folder"], &[ENVIRONMENT, "--resume"]),
        (&["bench", "--set", "paper", "--scenes", "nowhere"], &["nowhere", "--scenes"]),
        (&["bench", "--set", "builtin", "--scenes", "folder"], &["--scenes folder", "--set paper"]),
        (&["build", "missing.ply"], &["missing.ply"]),
        (&["bench", "sheet.ply", "--tree", "sheet.ply"], &["sheet.ply: not a saved tree", "`phr build -o`"]),
        (&["build", "sheet.ply", "-o", "x.phrtree"], &["--output x.phrtree", "--builder"]),
        (&["build", "sheet.ply", "--builder", "lbvh", "-o", "no/x"], &["no/x", "no such folder"]),
        (
            &["build", "sheet.ply", "--builder", "lbvh", "-o", "sheet.ply"],
            &["sheet.ply: is there, and no saved tree", "another name"],
        ),
        (
            &["tune", "sheet.ply", "--rays", "1M", "-o", "sheet.ply"],
            &["sheet.ply: is there, and no configuration"],
        ),
        (&["kernels", "sheet.ply", "./sheet.ply"], &["two scenes", "sheet"]),
        (&["scaling", "sheet.ply", "./sheet.ply"], &["two scenes", "sheet"]),
        (&["build", "sheet.ply", "--builder", "bvh"], &["no builder is called bvh"]),
        (&["build", "sheet.ply", "--builder", "phr-speed/8"], &["--builder phr-speed --width 8"]),
        (&["build", "sheet.ply", "--builder", "phr-hq", "--width", "5"], &["--width 5", "phr-hq"]),
        (&["build", "sheet.ply", "--threads", "0"], &["--threads 0"]),
        (&["build", "sheet.ply", "--threads", "20000"], &["--threads 20000", "1024"]),
        (&["render", "sheet.ply", "-o", "x.png", "--threads", "20000"], &["--threads 20000"]),
        (&["bench", "sheet.ply", "--name", "../../x"], &["--name ../../x"]),
        (&["bench", "sheet.ply", "--name", ".."], &["--name .."]),
        (&["bench", "sheet.ply", "--host", "=cmd"], &["--host =cmd"]),
        (&["experiment", "grid", "sheet.ply", "--host", "a|b"], &["--host a|b"]),
        (
            &["tune", "sheet.ply", "--rays", "1M", "--seconds", "18446744073709551615"],
            &["--seconds", "86400"],
        ),
        (&["advise", "sheet.ply", "--seconds", "99999"], &["--seconds", "86400"]),
        (&["kernels", "sheet.ply", "--rounds", "100000"], &["--rounds 100000", "65536"]),
        (&["kernels", "sheet.ply", "--size", "0"], &["--size 0"]),
        (&["build", "sheet.ply", "--max-memory", "1k"], &["sheet.ply", "--max-memory"]),
        (&["render", generated, "-o", "x.png", "--view", "99"], &["--view 99", generated]),
        (&["render", "sheet.ply", "-o", "nowhere/x.png"], &["nowhere", "folder"]),
        (&["render", "sheet.ply", "-o", "folder"], &["folder", "directory"]),
        (&["render", "sheet.ply", "-o", "x.png", "--size", "0"], &["--size 0"]),
        (&["render", "sheet.ply", "-o", "x.png", "--width", "5"], &["--width 5", "phr-hq"]),
        (&["render", "sheet.ply", "-o", "x.png", "--tree", "sheet.ply"], &["sheet.ply: not a saved tree"]),
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
    let mut unheard = std::process::Command::new(env!("CARGO_BIN_EXE_phr"));
    unheard.args(["bench", "missing.ply"]).current_dir(&folder);
    if let Ok(full) = std::fs::File::create("/dev/full") {
        assert_eq!(unheard.stderr(full).status().unwrap().code(), Some(2), "nobody reads what is told");
    }
    assert_eq!(phr(&folder, &["bench", "--no-such-option"]).status.code(), Some(2));
    assert_eq!(phr(&folder, &[]).status.code(), Some(2));
}

/// What is wrong with a file is told with what can be done about that very file.
#[test]
fn damaged_files_have_remedies_of_their_own() {
    let (_keep, folder) = workplace();
    for name in ["run", "tuned"] {
        std::fs::create_dir(folder.join(name)).unwrap();
    }
    row::write(
        &folder.join("run").join(ROWS),
        &[Row { schema: row::SCHEMA, width: 4, threads: 2, ..Row::default() }],
    )
    .unwrap();
    std::fs::write(folder.join("run").join(ENVIRONMENT), "x").unwrap();
    std::fs::write(folder.join("tuned/tune.csv"), "a,b\n1,2\n").unwrap();
    std::fs::write(folder.join("old.json"), "{}").unwrap();
    let fit = "phr advise --fit RESULTS --model FILE";
    let cases: [(&[&str], &str, &str); 7] = [
        (&["report", "run"], ENVIRONMENT, "remove it: then the machine is not known"),
        (&["table", "run"], ENVIRONMENT, "remove it: then the machine is not known"),
        (&["bench", "sheet.ply", "--resume", "--out", "run"], ENVIRONMENT, "run without --resume"),
        (&["tune", "--judge", "tuned"], "tune.csv", "run `phr tune`"),
        (&["advise", "scalable-2k", "--instant", "--model", "none.json"], "none.json", fit),
        (&["advise", "scalable-2k", "--instant", "--model", "old.json"], "old.json", fit),
        (&["build", "sheet.ply", "--builder", "phr-hq", "--width", "5"], "--width 5", "give one of these"),
    ];
    for (arguments, file, remedy) in cases {
        let output = phr(&folder, arguments);
        let told = text(&output.stderr);
        assert_eq!((output.status.code(), told.lines().count()), (Some(2), 1), "{arguments:?}: {told}");
        assert!(told.contains(file) && told.contains(remedy), "{arguments:?}: {told}");
        assert!(!told.contains("remove the folder"), "{told}");
    }
}

#[test]
fn listing_and_dry_runs_touch_nothing() {
    let (_keep, folder) = workplace();
    let list = phr(&folder, &["bench", "sheet.ply", "--list", "--builder", "phr-hq"]);
    assert!(text(&list.stdout).lines().any(|line| line == "sheet phr-hq 4 phr"), "{}", text(&list.stdout));
    let dry = phr(&folder, &tiny("sheet.ply", &["--dry-run"]));
    assert!(dry.status.success() && text(&dry.stdout).contains("visits"), "{}", text(&dry.stdout));
    let told = format!("sheet: file sheet.ply, 1152 triangles, {} trees\n", trees());
    assert!(text(&dry.stdout).contains(&told), "{}", text(&dry.stdout));
    let once = phr(&folder, &tiny("sheet.ply", &["--dry-run", "--rounds", "1"]));
    assert!(text(&once.stdout).contains(" visits in 1 round, "), "{}", text(&once.stdout));
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
    for label in ["build (new memory)", "rebuild (memory reused)", "first build (new builder, once)"] {
        assert!(told.contains(&format!("\n  {label} ")), "{told}");
    }

    let build =
        phr(&folder, &["build", "sheet.ply", "--builder", "phr-hq", "--width", "8", "-o", "x.phrtree"]);
    assert!(build.status.success(), "{}", text(&build.stderr));
    assert!(text(&build.stdout).contains("loaded again"), "{}", text(&build.stdout));
    let scene = phr::scene::load(folder.join("sheet.ply")).unwrap();
    let saved = phr::bvh::Bvh8::load(&scene.mesh, folder.join("x.phrtree")).unwrap();
    assert_eq!(saved.validate(&scene.mesh), Ok(()));
    let bench = phr(&folder, &tiny("sheet.ply", &["--rounds", "1", "--tree", "x.phrtree"]));
    assert!(bench.status.success(), "{}", text(&bench.stderr));
    let verdict = text(&bench.stdout);
    let (_, verdict) = verdict.split_once("## out: ").unwrap();
    let of_saved: Vec<&str> = verdict.lines().filter(|line| line.contains("saved:x")).collect();
    assert!(of_saved.len() == 1 && of_saved[0].starts_with("saved:x / 8 loads in "), "{verdict}");
    let rows = row::read(&folder.join("out")).unwrap();
    let loaded: Vec<&Row> = rows.iter().filter(|row| row.builder == "saved:x" && row.is_total()).collect();
    assert!(loaded.iter().any(|row| row.verified == Some(true)), "{loaded:?}");
    assert!(
        loaded.iter().all(|row| row.width == 8 && row.is_good() && row.builder_config.contains("phr-hq"))
    );
    std::fs::create_dir(folder.join("folder")).unwrap();
    std::fs::copy(folder.join("x.phrtree"), folder.join("folder/x.phrtree")).unwrap();
    let twice = phr(&folder, &["bench", "sheet.ply", "--tree", "x.phrtree", "--tree", "folder/x.phrtree"]);
    assert_eq!(twice.status.code(), Some(2));
    assert!(
        text(&twice.stderr).contains("folder/x.phrtree: named like x.phrtree"),
        "{}",
        text(&twice.stderr)
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
    assert_eq!(text(&render.stdout), "x.png: sheet view 0, 1152 triangles, 16 x 16, phr-hq / 4\n");
    let render = |more: &[&str]| {
        phr(
            &folder,
            &[&["render", "sheet.ply", "-o", "y.png", "--size", "16", "--samples", "2"], more].concat(),
        )
    };
    for (more, tree) in
        [(&["--builder", "lbvh", "--width", "8"][..], "lbvh / 8"), (&["--tree", "x.phrtree"], "saved:x / 8")]
    {
        let rendered = render(more);
        assert!(rendered.status.success(), "{}", text(&rendered.stderr));
        assert!(text(&rendered.stdout).ends_with(&format!(", {tree}\n")), "{}", text(&rendered.stdout));
        let [first, second] = ["x.png", "y.png"].map(|file| std::fs::read(folder.join(file)).unwrap());
        assert!(first == second, "the picture of {tree} is another one");
    }
    let both = render(&["--tree", "x.phrtree", "--width", "8"]);
    assert!(
        both.status.code() == Some(2) && text(&both.stderr).contains("--width"),
        "{}",
        text(&both.stderr)
    );

    let verify = phr(&folder, &["verify", "sheet.ply", "--size", "32"]);
    let told = text(&verify.stdout);
    assert!(verify.status.success() && told.contains("verified") && !told.contains("WRONG"), "{told}");
    // A scene without area, of which Embree prints no cost.
    std::fs::write(folder.join("point.obj"), "v 1 1 1\nf 1 1 1\nf 1 1 1\n").unwrap();
    let verify = phr(&folder, &["verify", "point.obj", "--size", "16"]);
    assert!(verify.status.success(), "{}", text(&verify.stderr));
}

/// Their answers would all be alike: no hit has a distance.
#[test]
fn scenes_too_large_to_trace_are_refused_and_built_all_the_same() {
    let (_guard, folder) = workplace();
    std::fs::write(folder.join("huge.obj"), "v 0 0 0\nv 1e13 0 0\nv 0 1e13 1e12\nf 1 2 3\n").unwrap();
    for arguments in [
        &["verify", "huge.obj", "--size", "16"][..],
        &["kernels", "huge.obj", "--size", "16"],
        &["render", "huge.obj", "-o", "x.png", "--size", "16"],
        &["advise", "huge.obj", "--seconds", "1"],
        &tiny("huge.obj", &["--rounds", "1"]),
    ] {
        let output = phr(&folder, arguments);
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(
            told.contains("huge: ") && told.contains("1.0e13 across") && told.contains("scale"),
            "{told}"
        );
    }
    assert!(!folder.join("out").exists(), "a refused run writes nothing");
    let built = phr(&folder, &["build", "huge.obj", "--builder", "phr-speed"]);
    assert!(built.status.success(), "{}", text(&built.stderr));
    let timed =
        ["bench", "huge.obj", "--build-only", "--rounds", "1", "--builder", "lbvh", "--out", "builds"];
    let timed = phr(&folder, &timed);
    assert!(timed.status.success(), "{}", text(&timed.stderr));
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
    std::fs::create_dir(folder.join("scenes")).unwrap();
    let scene = "scenes/sheet.ply";
    std::fs::copy(folder.join("sheet.ply"), folder.join(scene)).unwrap();
    let compare = |program: &str, more: &[&str]| {
        let arguments = ["compare", "--against", program, scene, "--builder", "lbvh", "--seconds", "1"];
        phr(&folder, &[&arguments[..], more].concat())
    };
    let output = compare(this, &["--threads", "1"]);
    let table = text(&output.stdout);
    // What it decides depends on the machine.
    assert!(matches!(output.status.code(), Some(0 | 1 | 3)), "{}", text(&output.stderr));
    assert_eq!(table.lines().filter(|line| line.starts_with("| lbvh / 4 ")).count(), 2, "{table}");
    assert!(table.contains("1 builders: ") && table.contains(" sessions of fresh processes"), "{table}");
    assert!(table.contains("| lbvh / 4 | sheet |") && !table.contains(scene), "{table}");
    let output = compare(this, &["--width", "4", "--width", "8", "--out", "kept"]);
    assert!(matches!(output.status.code(), Some(0 | 1 | 3)), "{}", text(&output.stderr));
    let rows = turns::read(&folder.join("kept")).unwrap();
    assert!(rows.len() >= 10 && rows.iter().all(|row| row.before_rev == row.after_rev && row.ratio > 0.0));
    std::fs::write(folder.join("page.md"), "<!-- turns: kept -->\n<!-- end -->\n").unwrap();
    assert!(phr(&folder, &["readme", "page.md"]).status.success());
    let page = std::fs::read_to_string(folder.join("page.md")).unwrap();
    assert!(
        page.contains("| lbvh / 4 |") && page.contains("| lbvh / 8 |") && page.contains(&rows[0].cpu),
        "{page}"
    );
    let refused: [(&str, &[&str]); 8] = [
        (this, &["--threads", "0"]),
        (this, &["--threads", "99999"]),
        (this, &["--out", "sheet.ply"]),
        ("/bin/true", &[]),
        ("/no/such/program", &[]),
        (this, &["--builder", "nobody"]),
        (this, &["no.ply"]),
        // Both are called sheet.
        (this, &["sheet.ply"]),
    ];
    for (program, more) in refused {
        let output = compare(program, more);
        assert_eq!((output.status.code(), text(&output.stderr).lines().count()), (Some(2), 1), "{program}");
    }
    assert_eq!(phr(&folder, &["compare", "one"]).status.code(), Some(2));
}

#[test]
fn every_verb_with_builders_takes_a_configuration() {
    let (_place, folder) = workplace();
    let config = r#"{"name": "mine", "base": "phr-fast", "width": 8, "fields": {"delta": 7}}"#;
    std::fs::write(folder.join("mine.json"), config).unwrap();
    let this = env!("CARGO_BIN_EXE_phr");
    let animate =
        ["animate", "wrung", "--width", "8", "--triangles", "2000", "--frames", "2", "--rounds", "1"];
    let cases: &[&[&str]] = &[
        &["bench", "sheet.ply", "--rounds", "1", "--size", "16", "--out", "out"],
        &["build", "sheet.ply"],
        &["render", "sheet.ply", "-o", "x.png", "--size", "16", "--samples", "1"],
        &["verify", "sheet.ply", "--size", "16"],
        &["advise", "sheet.ply", "--seconds", "1", "--out", "advice"],
        &["heatmap", "sheet.ply", "--size", "16", "-o", "map.png"],
        &["scaling", "sheet.ply", "--rounds", "1", "--workers", "2"],
        &["kernels", "sheet.ply", "--rounds", "1", "--size", "16"],
        &animate,
        &["compare", "--against", this, "sheet.ply", "--seconds", "1"],
    ];
    for arguments in cases {
        let output = phr(&folder, &[arguments, &["--config", "mine.json"][..]].concat());
        let told = text(&output.stdout);
        // What a comparison decides depends on the machine.
        let fits = |code| code == 0 || arguments[0] == "compare" && matches!(code, 1 | 3);
        assert!(output.status.code().is_some_and(fits), "{arguments:?}: {}", text(&output.stderr));
        assert!(told.contains("mine") && !told.contains("phr-hq"), "{arguments:?}: {told}");
    }
    for arguments in cases.iter().filter(|it| ["heatmap", "scaling", "kernels", "animate"].contains(&it[0])) {
        let mut again = [arguments, &["--set", "phr-fast.delta=7"][..]].concat();
        if arguments[0] != "heatmap" {
            let refused = phr(&folder, &again);
            assert!(text(&refused.stderr).contains("--replace"), "{arguments:?} {}", text(&refused.stderr));
            again.push("--replace");
        }
        let output = phr(&folder, &again);
        let (told, wrong) = (text(&output.stdout), text(&output.stderr));
        assert!(
            output.status.success() && told.contains("phr-fast[delta=7]"),
            "{arguments:?}: {told}{wrong}"
        );
    }
    let help = text(&phr(&folder, &["--help"]).stdout);
    let verbs = help.lines().filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    let with_builders = verbs.filter(|verb| {
        verb.starts_with(|first: char| first.is_ascii_lowercase())
            && text(&phr(&folder, &[*verb, "--help"]).stdout).contains("--builder <NAME>")
    });
    let with_builders: Vec<&str> = with_builders.collect();
    assert!(with_builders.contains(&"bench"), "{help}");
    for verb in with_builders {
        assert!(cases.iter().any(|arguments| arguments[0] == verb), "phr {verb} --config");
    }
    let twice = phr(&folder, &["scaling", "sheet.ply", "--config", "mine.json", "--config", "mine.json"]);
    assert_eq!((twice.status.code(), text(&twice.stderr).lines().count()), (Some(2), 1));
}
