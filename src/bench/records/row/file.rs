//! Reading and writing `rows.csv`: as a whole or not at all, also where a file was cut at a row's end.

use super::{ROWS, Row, SCHEMA};
use crate::bench::environment::{self, ENVIRONMENT, State};
use crate::bench::files::{MEASURE, MOST, RecordsError, TELL, Written, read_json, read_lines, write_whole};
use crate::bench::rounds::{self, ROUNDS, RowKey, RowRounds};
use std::collections::HashMap;
use std::path::Path;

/// Reads `rows.csv`, or that file in the results folder `path`, with the `rounds.csv` beside it.
///
/// # Errors
/// Missing, malformed, cut or empty files, those of another [`SCHEMA`], and figures that cannot be.
pub fn read(path: &Path) -> Result<Vec<Row>, RecordsError> {
    let path = if path.is_dir() { path.join(ROWS) } else { path.to_owned() };
    let remedy = MEASURE;
    let bytes = read_lines(&path, remedy)?;
    let mut rows = Vec::new();
    for row in csv::Reader::from_reader(&bytes[..]).deserialize() {
        let row: Row =
            row.map_err(|source| RecordsError::Malformed { path: path.clone(), source, remedy })?;
        if row.schema != SCHEMA {
            return Err(RecordsError::Schema { path, found: row.schema, expected: SCHEMA, remedy });
        }
        let unusable = |value: f64| !(0.0..=MOST).contains(&value);
        if let Some((column, Some(value))) =
            row.figures().into_iter().find(|(_, value)| value.is_some_and(unusable))
        {
            return Err(RecordsError::Figure { path, line: rows.len() + 2, column: column.into(), value });
        }
        rows.push(row);
    }
    let (times, lines) = rounds::read(&path.with_file_name(ROUNDS))?;
    let mut by_round: HashMap<RowKey, RowRounds> = times.into_iter().collect();
    for row in rows.iter_mut().filter(|row| row.is_total()) {
        row.by_round = by_round.remove(&row.key()).unwrap_or_default();
    }
    check_whole(&path, Written { rows: rows.len(), rounds: lines }, by_round.keys().next())?;
    if rows.is_empty() { Err(RecordsError::Empty { path, remedy }) } else { Ok(rows) }
}

/// How a run ended, of an environment of any age.
#[derive(serde::Deserialize)]
struct Ended {
    state: State,
    #[serde(default)]
    written: Option<Written>,
}

impl Ended {
    /// Of the environment beside the file `path`; nothing where there is none.
    fn beside(path: &Path) -> Result<Option<Self>, RecordsError> {
        let path = path.with_file_name(ENVIRONMENT);
        path.is_file().then(|| read_json(&path, environment::REMEDY)).transpose()
    }
}

/// Refuses files with fewer lines than were written, and rounds of a row that is not there. Of a run under way neither
/// is known; an older one tells of its rounds only.
fn check_whole(path: &Path, found: Written, left_over: Option<&RowKey>) -> Result<(), RecordsError> {
    let is_results = path.file_name().is_some_and(|name| name == ROWS);
    let environment = if is_results { Ended::beside(path)? } else { None };
    if environment.as_ref().is_some_and(|environment| environment.state == State::Running) {
        return Ok(());
    }
    let cut = |file: &'static str, found: usize, written: usize| {
        Err(RecordsError::Cut { path: path.with_file_name(file), found, written, remedy: MEASURE })
    };
    if let Some(written) = environment.and_then(|environment| environment.written) {
        if found.rows != written.rows {
            return cut(ROWS, found.rows, written.rows);
        }
        if found.rounds != written.rounds {
            return cut(ROUNDS, found.rounds, written.rounds);
        }
    }
    match left_over {
        Some(key) => {
            let row = format!("{} {}/{}", key.scene, key.builder, key.width);
            Err(RecordsError::RowMissing { path: path.to_owned(), row })
        }
        None => Ok(()),
    }
}

/// Writes `rows` to the folder: `rows.csv`, and `rounds.csv` where the times of rounds are known.
///
/// # Errors
/// An unwritable place.
pub fn write_all(folder: &Path, rows: &[Row]) -> Result<Written, RecordsError> {
    let totals: Vec<(RowKey, &RowRounds)> =
        rows.iter().filter(|row| row.is_total()).map(|row| (row.key(), &row.by_round)).collect();
    let rounds = rounds::write(folder, &totals)?;
    write(&folder.join(ROWS), rows)?;
    Ok(Written { rows: rows.len(), rounds })
}

/// Writes `rows` to the file `path`, whole or not at all.
///
/// # Errors
/// An unwritable place.
pub fn write(path: &Path, rows: &[Row]) -> Result<(), RecordsError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let malformed = |source| RecordsError::Malformed { path: path.to_owned(), source, remedy: TELL };
    for row in rows {
        writer.serialize(row).map_err(malformed)?;
    }
    let bytes = writer.into_inner().map_err(|error| malformed(error.into_error().into()))?;
    write_whole(path, &bytes)
}
