use super::*;
use crate::bench::environment::ENVIRONMENT;
use crate::bench::files::{RecordsError, last_line};
use crate::bench::rounds::ROUNDS;
use std::path::Path;

impl Row {
    /// A verified row of scene `a` for tests of reports: three rounds of two threads without spread.
    pub(crate) fn by_hand(builder: &str, width: u32, kernel: &str, build: f64, trace: f64) -> Self {
        Self {
            schema: SCHEMA,
            scene: "a".into(),
            builder: builder.into(),
            width,
            regime: WARM.into(),
            rounds: 3,
            threads: 2,
            build_ms_median: Some(build),
            build_ms_mad: Some(0.0),
            build_ms_min: Some(build),
            build_ms_max: Some(build),
            view: ALL.into(),
            ray_kind: ALL.into(),
            kernel: kernel.into(),
            trace_ms_median: Some(trace),
            trace_ms_mad: Some(0.0),
            trace_ms_min: Some(trace),
            trace_ms_max: Some(trace),
            verified: Some(true),
            ..Self::default()
        }
    }
}

fn row() -> Row {
    Row {
        schema: SCHEMA,
        threads: 2,
        scene: "a, \"quoted\" scene".into(),
        builder: "phr-hq".into(),
        builder_config: r#"{"alpha":0.55,"delta":9}"#.into(),
        width: 4,
        build_ms_median: Some(12.5),
        rays: Some(1 << 40),
        verified: Some(true),
        view: ALL.into(),
        ray_kind: ALL.into(),
        ..Row::default()
    }
}

#[test]
fn rows_survive_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let rows = [row(), Row { error: "mismatch\nin two lines".into(), verified: None, ..row() }];
    write(&folder.path().join(ROWS), &rows).unwrap();
    assert_eq!(read(folder.path()).unwrap(), rows);
    assert_eq!(read(&folder.path().join(ROWS)).unwrap(), rows);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no part file is left");
}

#[test]
fn other_files_are_refused_with_place_and_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let missing = read(folder.path()).unwrap_err().to_string();
    assert!(missing.contains(ROWS) && missing.contains("phr bench"), "{missing}");

    let path = folder.path().join(ROWS);
    std::fs::write(&path, "a,b\n1,2\n").unwrap();
    assert!(matches!(read(&path), Err(RecordsError::Malformed { .. })));
    write(&path, &[]).unwrap();
    assert!(matches!(read(&path), Err(RecordsError::Empty { .. })));
    write(&path, &[Row { schema: 99, ..row() }]).unwrap();
    assert!(matches!(read(&path), Err(RecordsError::Schema { found: 99, .. })));
}

#[test]
fn an_unwritable_place_is_an_error() {
    let error = write(Path::new("/proc/no/such/rows.csv"), &[row()]).unwrap_err().to_string();
    assert!(error.contains("/proc/no/such/rows.csv") && error.contains("--out"), "{error}");
}

#[test]
fn figures_that_cannot_be_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(ROWS);
    write(&path, &[row()]).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(",12.5,"));
    for (column, row) in [("width", Row { width: 5, ..row() }), ("threads", Row { threads: 0, ..row() })] {
        write(&path, &[row]).unwrap();
        let error = read(folder.path()).unwrap_err().to_string();
        assert!(error.contains(&format!("line 2: {column} is")), "{error}");
    }
    for figure in ["NaN", "inf", "-1", "1e308"] {
        std::fs::write(&path, text.replace(",12.5,", &format!(",{figure},"))).unwrap();
        let error = read(folder.path()).unwrap_err().to_string();
        assert!(error.contains("line 2: build_ms_median is") && error.contains(';'), "{error}");
    }
}

/// Three rows with the times of two rounds each.
fn with_rounds() -> [Row; 3] {
    let rounds = |scene: &str| Row {
        scene: scene.into(),
        by_round: RowRounds { build: vec![(0, 10.25), (1, 11.75)], ..RowRounds::default() },
        build_ms_median: Some(11.0),
        build_ms_mad: Some(0.75),
        build_ms_min: Some(10.25),
        build_ms_max: Some(11.75),
        ..row()
    };
    [rounds("a"), rounds("b"), Row { error: "an error\nin two lines".into(), ..rounds("c") }]
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let rows = with_rounds();
    write_all(folder.path(), &rows).unwrap();
    for file in [ROWS, ROUNDS] {
        let whole = std::fs::read(folder.path().join(file)).unwrap();
        for end in 0..whole.len() {
            std::fs::write(folder.path().join(file), &whole[..end]).unwrap();
            let error = read(folder.path()).unwrap_err().to_string();
            assert!(error.contains(file) && !error.contains('\n'), "{file} up to {end}: {error}");
        }
        std::fs::write(folder.path().join(file), whole).unwrap();
    }
    assert_eq!(read(folder.path()).unwrap(), rows);
}

/// As older programs wrote them, and what came from elsewhere without its environment.
#[test]
fn without_a_last_line_the_environment_tells_the_number() {
    let folder = tempfile::tempdir().unwrap();
    let place = |file: &str| folder.path().join(file);
    let rows = with_rounds();
    write_all(folder.path(), &rows).unwrap();
    for file in [ROWS, ROUNDS] {
        let text = std::fs::read_to_string(place(file)).unwrap();
        std::fs::write(place(file), text.strip_suffix(&last_line(3)).unwrap()).unwrap();
    }
    let told = |file: &str| read(&place(file)).unwrap_err().to_string();
    let unknown = |file: &str, told: &str| {
        let what = format!("{file}: no last line `# rows: N` nor an environment.json");
        let remedy = "; if its 3 rows are all, add the line `# rows: 3`";
        assert!(told.contains(&what) && told.contains(remedy), "{told}");
    };
    unknown(ROWS, &told(ROWS));
    let environment = |text: &str| std::fs::write(place(ENVIRONMENT), text).unwrap();
    for state in ["complete", "running"] {
        environment(&format!("{{\"state\": \"{state}\"}}"));
        unknown(ROWS, &told(ROWS));
    }
    let written = |rows: usize, rounds: usize| {
        environment(&format!(
            "{{\"state\": \"complete\", \"written\": {{\"rows\": {rows}, \"rounds\": {rounds}}}}}"
        ));
    };
    written(3, 3);
    assert_eq!(read(folder.path()).unwrap(), rows);
    std::fs::copy(place(ROWS), place("other.csv")).unwrap();
    unknown("other.csv", &told("other.csv"));
    written(4, 3);
    assert!(told(ROWS).contains("rows.csv: 3 rows, where 4 were written"), "{}", told(ROWS));
    written(3, 2);
    assert!(told(ROWS).contains("rounds.csv: 3 rows, where 2 were written"), "{}", told(ROWS));

    // The line that the error tells to add.
    std::fs::remove_file(place(ENVIRONMENT)).unwrap();
    let add = |file: &str| {
        let text = std::fs::read_to_string(place(file)).unwrap();
        std::fs::write(place(file), text + &last_line(3)).unwrap();
    };
    add(ROWS);
    unknown(ROUNDS, &told(ROWS));
    add(ROUNDS);
    assert_eq!(read(folder.path()).unwrap(), rows);
    written(4, 3);
    assert!(told(ROWS).contains("where 4 were written"), "both are to agree");
}

#[test]
fn figures_that_are_not_those_of_their_rounds_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let by_round = RowRounds {
        build: vec![(0, 10.25), (1, 11.75)],
        trace: vec![(0, 3.0), (1, 3.0)],
        ..RowRounds::default()
    };
    let row = Row { by_round, ..Row::by_hand("lbvh", 4, "phr", 11.0, 3.0) };
    let row = Row { build_ms_mad: Some(0.75), build_ms_min: Some(10.25), build_ms_max: Some(11.75), ..row };
    write_all(folder.path(), std::slice::from_ref(&row)).unwrap();
    assert_eq!(read(folder.path()).unwrap(), std::slice::from_ref(&row));
    for changed in [
        Row { build_ms_median: Some(10.9), ..row.clone() },
        Row { build_ms_mad: Some(0.7), ..row.clone() },
        Row { build_ms_min: Some(10.0), ..row.clone() },
        Row { trace_ms_max: Some(3.1), ..row.clone() },
        Row { build_ms_median: None, ..row.clone() },
        Row { build_ms_mad: None, build_ms_median: Some(10.9), ..row.clone() },
    ] {
        write(&folder.path().join(ROWS), &[changed]).unwrap();
        let error = read(folder.path()).unwrap_err();
        let text = error.to_string();
        assert!(matches!(error, RecordsError::Changed { line: 2, .. }), "{text}");
        assert!(text.contains(ROWS) && text.contains("by its rounds") && text.contains(';'), "{text}");
    }
}

#[test]
fn rows_of_two_runs_of_a_scene_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let of = |scene: &str, run: &str| Row { scene: scene.into(), run_id: run.into(), ..row() };
    let write = |rows: &[Row]| write(&folder.path().join(ROWS), rows).unwrap();
    // Shards are runs of their own.
    write(&[of("a", "1"), of("a", "1"), of("b", "2")]);
    read(folder.path()).unwrap();
    write(&[of("a", "1"), of("b", "2"), of("a", "2")]);
    let error = read(folder.path()).unwrap_err();
    assert!(matches!(&error, RecordsError::TwoRuns { line: 4, scene, .. } if scene == "a"), "{error}");
    assert!(error.to_string().contains("phr merge"), "{error}");
}
