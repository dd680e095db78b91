use super::*;

fn row() -> Row {
    Row {
        schema: SCHEMA,
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
