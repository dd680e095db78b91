//! A results folder after the run: its rows and those of its subfolders, whether the run was completed, and the
//! reduced rows that a repository keeps.

use super::environment::{self, ENVIRONMENT, Environment, State};
use super::files::{RecordsError, new_folder, read_json, write_json};
use super::phases;
use super::row::{self, ROWS, Row, SCHEMA};
use super::samples::SAMPLES;
use crate::bench::error::ReduceError;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// The table.
pub const TABLE: &str = "table1.md";
/// The page.
pub const PAGE: &str = "report.html";
/// The figures by name, each an SVG and a PNG.
pub const FIGURES: [&str; 7] =
    ["figure6", "figure6-own", "figure6-paper", "figure6-scenes", "growth", "threads", "phases"];

/// The environment of the results in `place`, a folder or its rows; `None` where there is none, as beside a lone CSV.
///
/// # Errors
/// A file of another content or schema.
pub fn environment(place: &Path) -> Result<Option<Environment>, RecordsError> {
    let is_rows = place.file_name().is_some_and(|name| name == ROWS) && place.is_file();
    let path = if is_rows { place.with_file_name(ENVIRONMENT) } else { place.join(ENVIRONMENT) };
    if !path.is_file() {
        return Ok(None);
    }
    let found: Environment = read_json(&path, environment::REMEDY)?;
    match found.schema {
        SCHEMA => Ok(Some(found)),
        found => Err(RecordsError::Schema { path, found, expected: SCHEMA, remedy: environment::REMEDY }),
    }
}

/// False if the environment is that of a stopped run. For a lone CSV only the warnings can tell.
pub fn is_complete(environment: Option<&Environment>) -> bool {
    environment.is_none_or(|found| found.state == State::Complete)
}

/// The folders with rows among `path` and its subfolders, itself first and the others by name; a file, or a
/// folder without any, is returned alone, so that reading it reports the missing file.
pub fn parts(path: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(path).into_iter().flatten().filter_map(Result::ok);
    let mut found: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    found.retain(|folder| folder.join(ROWS).is_file());
    found.sort();
    if found.is_empty() || path.join(ROWS).is_file() {
        found.insert(0, path.to_owned());
    }
    found
}

/// The rows of `paths` and of their subfolders, and whether all their runs were finished.
///
/// # Errors
/// Those of [`row::read`] and [`environment()`].
pub fn read_all(paths: &[PathBuf]) -> Result<(Vec<Row>, bool), RecordsError> {
    let (mut rows, mut are_complete) = (Vec::new(), true);
    for part in paths.iter().flat_map(|path| parts(path)) {
        rows.extend(row::read(&part)?);
        are_complete &= is_complete(environment(&part)?.as_ref());
    }
    Ok((rows, are_complete))
}

/// Reduces the results in `from` and its subfolders to the rows that sum over views and kinds of rays, and writes
/// them to `to` with the environment as it is; the parameters of a builder stand in its first row alone. Returns the
/// folders written.
///
/// # Errors
/// Those of [`ReduceError`].
pub fn reduce(from: &Path, to: &Path) -> Result<Vec<PathBuf>, ReduceError> {
    if is_inside(to, from) {
        return Err(ReduceError::Inside(to.to_owned()));
    }
    let mut reduced = Vec::new();
    for part in parts(from) {
        let mut rows: Vec<Row> = row::read(&part)?.into_iter().filter(Row::is_total).collect();
        let mut told = HashSet::new();
        for row in &mut rows {
            if !told.insert((row.builder.clone(), row.width, row.builder_config.clone())) {
                row.builder_config.clear();
            }
        }
        let phases = phases::read(&part)?;
        reduced.push((part, rows, phases));
    }
    let place = |part: &Path| {
        let below = if part == from { None } else { part.file_name() };
        below.map_or_else(|| to.to_owned(), |name| to.join(name))
    };
    let mut places = reduced.iter().map(|(part, ..)| place(part));
    if let Some(taken) = places.find(|folder| folder.join(SAMPLES).exists()) {
        return Err(ReduceError::Taken(taken));
    }
    let mut folders = Vec::new();
    for (part, rows, phases) in reduced {
        let folder = place(&part);
        new_folder(&folder)?;
        remove_made_of_rows(&folder, &[ENVIRONMENT])?;
        phases::write(&folder, &phases)?;
        let written = Some(row::write_all(&folder, &rows)?);
        if let Some(environment) = environment(&part)? {
            write_json(&folder.join(ENVIRONMENT), &Environment { written, ..environment })?;
        }
        folders.push(folder);
    }
    Ok(folders)
}

/// True if `to`, which need not exist, is the folder of `from` or in it.
fn is_inside(to: &Path, from: &Path) -> bool {
    let from = if from.is_file() { from.parent().unwrap_or(from) } else { from };
    let existing = std::path::absolute(to).ok().and_then(|to| {
        let mut upwards = to.ancestors();
        upwards.find_map(|folder| folder.canonicalize().ok())
    });
    let from = std::path::absolute(from).ok().and_then(|from| from.canonicalize().ok());
    existing.zip(from).is_some_and(|(existing, from)| existing.starts_with(from))
}

/// Removes `records`, files of an older run, from `folder`, and what was made of its rows when it ended: no file of
/// it may be taken for part of a new one.
///
/// # Errors
/// A file that cannot be removed.
pub fn remove_made_of_rows(folder: &Path, records: &[&str]) -> Result<(), RecordsError> {
    let figures = FIGURES.iter().flat_map(|name| ["svg", "png"].map(|ending| format!("{name}.{ending}")));
    let made = records.iter().chain(&[TABLE, PAGE]).map(ToString::to_string).chain(figures);
    for path in made.map(|file| folder.join(file)).filter(|path| path.exists()) {
        let remedy = "remove it, or give another folder with --out";
        std::fs::remove_file(&path).map_err(|source| RecordsError::Io { path, source, remedy })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::row::ALL;

    fn row(scene: &str, view: &str, ray_kind: &str) -> Row {
        Row {
            schema: SCHEMA,
            scene: scene.into(),
            view: view.into(),
            ray_kind: ray_kind.into(),
            width: 4,
            threads: 2,
            ..Row::default()
        }
    }

    fn write(folder: &Path, rows: &[Row]) {
        std::fs::create_dir_all(folder).unwrap();
        row::write(&folder.join(ROWS), rows).unwrap();
    }

    #[test]
    fn subfolders_are_read_after_the_folder_itself() {
        let folder = tempfile::tempdir().unwrap();
        let all = |scene| row(scene, ALL, ALL);
        write(&folder.path().join("b"), &[all("b")]);
        write(&folder.path().join("a"), &[all("a")]);
        std::fs::create_dir(folder.path().join("empty")).unwrap();
        let all_of = |path: &Path| read_all(&[path.to_owned()]);
        let scenes = || all_of(folder.path()).unwrap().0.into_iter().map(|row| row.scene).collect::<Vec<_>>();
        assert_eq!(scenes(), ["a", "b"]);
        write(folder.path(), &[all("z")]);
        assert_eq!(scenes(), ["z", "a", "b"]);
        assert_eq!(all_of(&folder.path().join(ROWS)).unwrap().0.len(), 1, "a file alone");
        std::fs::write(folder.path().join(ENVIRONMENT), "{").unwrap();
        assert!(environment(&folder.path().join(ROWS)).is_err(), "it is that beside the file");
        std::fs::remove_file(folder.path().join(ENVIRONMENT)).unwrap();
        assert!(matches!(all_of(&folder.path().join("empty")), Err(RecordsError::Io { .. })));
    }

    #[test]
    fn an_environment_of_another_schema_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let committed = concat!(env!("CARGO_MANIFEST_DIR"), "/results/reference/environment.json");
        let text = std::fs::read_to_string(committed).unwrap();
        std::fs::write(folder.path().join(ENVIRONMENT), &text).unwrap();
        assert!(environment(folder.path()).unwrap().is_some());
        let other = text.replace("\"schema\": 1,", "\"schema\": 9,");
        std::fs::write(folder.path().join(ENVIRONMENT), other).unwrap();
        let error = environment(folder.path()).unwrap_err().to_string();
        assert!(error.contains(ENVIRONMENT) && error.contains("schema 9") && error.contains(';'), "{error}");
    }

    #[test]
    fn a_reduced_folder_has_the_sums() {
        let folder = tempfile::tempdir().unwrap();
        let (full, small) = (folder.path().join("full"), folder.path().join("small"));
        write(&full, &[row("a", ALL, ALL), row("a", "0", ALL), row("a", ALL, "shadow")]);
        write(&full.join("growth"), &[row("g", ALL, ALL)]);
        let written = reduce(&full, &small).unwrap();
        assert_eq!(written, [small.clone(), small.join("growth")]);
        assert_eq!(row::read(&small).unwrap(), [row("a", ALL, ALL)]);
        assert_eq!(row::read(&small.join("growth")).unwrap(), [row("g", ALL, ALL)]);
        for (from, to) in
            [(&full, full.clone()), (&full, full.join("small")), (&full.join(ROWS), full.clone())]
        {
            assert!(matches!(reduce(from, &to), Err(ReduceError::Inside(_))), "{to:?}");
        }
        assert!(!full.join("small").exists());
        assert_eq!(row::read(&full).unwrap().len(), 3, "nothing was lost");
    }
}
