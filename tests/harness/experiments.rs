//! Heat maps and experiments as a user meets them: what they write, that pictures come from the files beside them
//! alone, and what is refused.
use phr::bench::row::{self, ROWS};
use phr::experiments::animation::records;
use phr::report::readme::findings::FINDINGS;
use std::path::Path;
use std::process::{Command, Output};

fn phr(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_phr")).args(arguments).current_dir(folder).output().unwrap()
}

#[track_caller]
fn told(folder: &Path, arguments: &[&str]) -> String {
    let output = phr(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn bytes(folder: &Path, file: &str) -> Vec<u8> {
    std::fs::read(folder.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

#[test]
fn a_heat_map_is_drawn_again_from_the_files_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let builders = ["--builder", "lbvh", "--builder", "phr-hq"];
    let size = ["--size", "16", "--threads", "2", "-o", "map.png"];
    let text = told(folder, &[&["heatmap", "scalable-2k"], &builders[..], &size[..]].concat());
    assert!(text.contains("lbvh / 4: build") && text.contains("phr-hq / 4: build"), "{text}");
    let csv = String::from_utf8(bytes(folder, "map.csv")).unwrap();
    assert_eq!(csv.lines().count(), 4, "{csv}");
    let first = bytes(folder, "map.png");
    std::fs::remove_file(folder.join("map.png")).unwrap();
    told(folder, &["heatmap", "--redraw", "-o", "map.png"]);
    assert_eq!(bytes(folder, "map.png"), first);
    let check = ["heatmap", "--check", "-o", "map.png"];
    told(folder, &check);
    std::fs::write(folder.join("map.csv"), csv.replace("lbvh", "aac")).unwrap();
    let output = phr(folder, &check);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && error.contains("map.png: not the picture"), "{error}");
    told(folder, &["heatmap", "--redraw", "-o", "map.png"]);
    assert_ne!(bytes(folder, "map.png"), first);
}

#[test]
fn an_experiment_is_a_verified_run_with_findings_and_figures() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let run = ["experiment", "spatial-splits", "scalable-2k", "scalable-3k", "--rounds", "2", "--size", "8"];
    let text = told(folder, &[&run[..], &["--views", "1", "--threads", "2"]].concat());
    let lines = |start: &str| text.lines().filter(|line| line.starts_with(start)).count();
    // Means, and the claim of the paper; two rounds tell of no noise.
    assert!(lines("| phr-hq[spatial_threshold=off] ") >= 4, "{text}");
    assert_eq!(
        lines("| traces take 2 to 25 % longer without spatial splits "),
        4,
        "by time and by steps: {text}"
    );
    assert!(text.contains(" [?]") && text.contains(" is undecided "), "{text}");
    // Steps have no noise, and few rounds are warned of.
    let by = |what: &str| {
        text.lines()
            .filter(|line| line.split('|').nth(2).is_some_and(|it| it.trim() == what))
            .collect::<Vec<_>>()
    };
    assert!(by("steps").len() >= 2 && by("steps").iter().all(|line| !line.contains("[?]")), "{text}");
    assert!(text.contains("\nWarnings, by rows: ") && text.contains("TooFewSamples"), "{text}");
    let results = folder.join("results/experiments/spatial-splits");
    let rows = row::read(&results).unwrap();
    let mut builders: Vec<&str> = rows.iter().map(|row| row.builder.as_str()).collect();
    builders.sort_unstable();
    builders.dedup();
    let off = "[spatial_threshold=off]";
    assert_eq!(builders, ["phr-fast", &format!("phr-fast{off}"), "phr-hq", &format!("phr-hq{off}")]);
    let traced = rows.iter().filter(|row| row.is_total() && row.is_compared());
    assert!(traced.clone().count() >= 8 && traced.clone().all(|row| row.verified == Some(true)));
    assert!(traced.clone().all(|row| row.width == 4 && row.is_good()));

    told(folder, &["experiment", "spatial-splits", "--check"]);
    let drawn = bytes(&results, "effects.svg");
    std::fs::write(results.join("effects.svg"), "other").unwrap();
    assert_eq!(phr(folder, &["experiment", "spatial-splits", "--check"]).status.code(), Some(1));
    std::fs::write(results.join("effects.svg"), &drawn).unwrap();
    let picture = bytes(&results, "effects.png");
    std::fs::write(results.join("effects.png"), "other").unwrap();
    let output = phr(folder, &["experiment", "spatial-splits", "--check"]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && error.contains("effects.png: not the figure"), "{error}");
    let findings = bytes(&results, FINDINGS);
    std::fs::write(results.join(FINDINGS), "other").unwrap();
    assert_eq!(phr(folder, &["experiment", "spatial-splits", "--check"]).status.code(), Some(1));
    let again = told(folder, &["experiment", "spatial-splits", "--redraw"]);
    assert!(text.ends_with(&again), "after the tables of the run the same:\n{text}\n{again}");
    assert_eq!(bytes(&results, "effects.svg"), drawn);
    assert_eq!(bytes(&results, "effects.png"), picture);
    assert_eq!(bytes(&results, FINDINGS), findings);
}

#[test]
fn the_grid_has_its_front_and_each_scenes_best_point() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let run =
        ["experiment", "grid", "scalable-2k", "scalable-3k", "--rounds", "1", "--size", "8", "--views", "1"];
    let text = told(folder, &run);
    assert!(text.contains("The front in the mean over scenes") && text.contains("| scalable-3k "), "{text}");
    for figure in ["SAH cost", "steps", "trace"] {
        assert!(text.contains(&format!("\n* by {figure}: (")), "{text}");
    }
    let results = folder.join("results/experiments/grid");
    let svg = String::from_utf8(bytes(&results, "fronts.svg")).unwrap();
    assert!(svg.contains(">0.65, 10<") && svg.contains("alpha 0.45, delta 5 to 10"), "{svg}");
    assert!(bytes(&results, "fronts-scenes.png").starts_with(b"\x89PNG"));
    told(folder, &["experiment", "grid", "--check"]);
}

#[test]
fn cuts_and_splits_are_drawn_from_their_csv() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = told(folder, &["experiment", "cut-size", "scalable-3k", "scalable-2k", "--out", "cuts"]);
    assert!(text.contains("| phr-fast ") && text.contains("\nscalable-2k\n"), "{text}");
    told(folder, &["experiment", "cut-size", "--check", "--out", "cuts"]);
    told(folder, &["experiment", "split", "--out", "split"]);
    told(folder, &["experiment", "split", "--check", "--out", "split"]);
    for (file, csv) in
        [("split/spatial-split.svg", "split/split.csv"), ("cuts/cut-size.svg", "cuts/cut-size.csv")]
    {
        let drawn = bytes(folder, file);
        std::fs::write(folder.join(file), "").unwrap();
        let name = if csv.starts_with("cuts") { "cut-size" } else { "split" };
        let out = csv.split('/').next().unwrap();
        assert_eq!(phr(folder, &["experiment", name, "--check", "--out", out]).status.code(), Some(1));
        told(folder, &["experiment", name, "--redraw", "--out", out]);
        assert_eq!(bytes(folder, file), drawn);
    }
    std::fs::write(folder.join("cuts").join(FINDINGS), "other").unwrap();
    assert_eq!(phr(folder, &["experiment", "cut-size", "--check", "--out", "cuts"]).status.code(), Some(1));
}

#[test]
fn trees_follow_a_moving_scene_and_every_frame_is_verified() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let short = ["--triangles", "2000", "--frames", "3", "--size", "8", "--rounds", "1", "--threads", "2"];
    let text =
        told(folder, &[&["animate", "wrung", "parade"], &short[..], &["--builder", "phr-fast"]].concat());
    assert!(text.contains("# wrung") && text.contains("# parade"), "{text}");
    assert!(text.contains("| phr-fast, refine") && text.contains("| phr-fast, merge-sah"), "{text}");
    let results = folder.join("results/animation");
    let rows = records::read(&results).unwrap();
    let embrees = if cfg!(feature = "embree") { 3 } else { 0 };
    assert_eq!(rows.len(), 3 * (3 + embrees) + 3 * (5 + embrees), "no static part is merged in wrung");
    for row in &rows {
        assert!(row.verified && row.error.is_empty() && row.rays > 0, "{row:?}");
        assert!(row.build_ms > Some(0.0) && row.trace_ms > Some(0.0), "{row:?}");
    }
    // The last frame is another scene than the first.
    let costs: Vec<f64> = rows
        .iter()
        .filter(|row| row.scene == "wrung" && row.builder == "phr-fast" && row.update.name() == "refit")
        .filter_map(|row| row.sah)
        .collect();
    assert!(costs.len() == 3 && costs[2] > costs[0], "{costs:?}");

    told(folder, &["animate", "--check"]);
    let drawn = bytes(&results, "animation.svg");
    std::fs::write(results.join("animation.svg"), "other").unwrap();
    assert_eq!(phr(folder, &["animate", "--check"]).status.code(), Some(1));
    std::fs::write(results.join("animation.svg"), &drawn).unwrap();
    std::fs::write(results.join(FINDINGS), "other").unwrap();
    assert_eq!(phr(folder, &["animate", "--check"]).status.code(), Some(1));
    assert_eq!(told(folder, &["animate", "--redraw"]), text);
    assert_eq!(bytes(&results, "animation.svg"), drawn);
    std::fs::write(results.join("animation.png"), "other").unwrap();
    let output = phr(folder, &["animate", "--check"]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && error.contains("animation.png: not the figure"), "{error}");

    // One contestant's wrong answers make the whole run an error.
    let mut rows = rows;
    let last = rows.last_mut().unwrap();
    (last.verified, last.error) = (false, "wrong hits: one".into());
    records::write(&results.join(records::ANIMATION), &rows).unwrap();
    let output = phr(folder, &["animate", "--redraw"]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && error.contains("1 contestants failed"), "{error}");
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(told.contains(" failed in frame 2: wrong hits: one"), "{told}");
}

#[test]
fn what_says_how_to_measure_has_no_place_where_nothing_is_measured() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, useless) in [
        (["experiment", "grid", "--redraw", "--rounds", "2"], "--rounds"),
        (["experiment", "grid", "--check", "--seed", "2"], "--seed"),
        (["animate", "--redraw", "--width", "8", "--out=a"], "--width"),
    ] {
        let output = phr(folder.path(), &arguments);
        let told = String::from_utf8_lossy(&output.stderr);
        let is_told = told.contains("cannot be used with") && told.contains(useless);
        assert!(output.status.code() == Some(2) && is_told, "{arguments:?}: {told}");
    }
}

#[test]
fn what_cannot_be_done_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    let cases: Vec<(&[&str], &[&str])> = vec![
        (&["experiment", "nothing"], &["no experiment is called nothing", "grid", "cut-size", "split"]),
        (&["experiment", "grid", "missing.ply"], &["missing.ply"]),
        (&["experiment", "grid", "scalable-2k", "--width", "5"], &["--width", "4 or 8"]),
        (&["experiment", "grid", "--redraw", "--out", "empty"], &[ROWS]),
        (&["experiment", "cut-size", "--redraw", "--out", "empty"], &["cut-size.csv", "--redraw"]),
        (&["experiment", "split", "scalable-2k", "scalable-3k"], &["one scene"]),
        (&["experiment", "cut-size", "--rounds", "3"], &["--rounds has no effect", "leave it out"]),
        (&["experiment", "split", "--list"], &["--list has no effect"]),
        (&["heatmap", "scalable-2k", "-o", "map.svg"], &["map.svg", ".png"]),
        (&["heatmap", "scalable-2k", "-o", "no/map.png"], &["no", "folder"]),
        (&["heatmap", "scalable-2k", "-o", "map.png", "--view", "9"], &["--view 9"]),
        (&["heatmap", "scalable-2k", "-o", "map.png", "--size", "0"], &["--size"]),
        (&["heatmap", "scalable-2k", "-o", "map.png", "--builder", "bvh"], &["no builder is called bvh"]),
        (&["heatmap", "--redraw", "-o", "map.png"], &["map.csv", "--redraw"]),
        (&["heatmap", "--check", "-o", "map.png"], &["map.csv"]),
        (&["animate", "rooms"], &["no moving scene is called rooms", "wrung", "parade"]),
        (&["animate", "wrung", "--frames", "0"], &["--frames 0"]),
        (&["animate", "wrung", "--width", "5"], &["--width", "4 or 8"]),
        (&["animate", "wrung", "--triangles", "10"], &["--triangles 10", "1000"]),
        (&["animate", "wrung", "--kernel", "gpu"], &["--kernel gpu", "phr"]),
        (&["animate", "wrung", "--builder", "bvh"], &["no builder is called bvh"]),
        (&["animate", "wrung", "--rounds", "0"], &["--rounds 0"]),
        (&["animate", "--redraw", "--out", "empty"], &["animation.csv", "phr animate"]),
    ];
    for (arguments, wanted) in cases {
        let output = phr(folder.path(), arguments);
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
        assert_eq!(told.lines().count(), 1, "{arguments:?}: {told}");
        for part in wanted {
            assert!(told.contains(part), "{arguments:?}: no {part:?} in {told}");
        }
    }
}
