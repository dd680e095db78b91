//! Reading and writing `rows.csv`: as a whole or not at all, also where a file was cut at a row's end.

use super::{ROWS, Row, SCHEMA, agreement};
use crate::bench::environment::{self, ENVIRONMENT, State};
use crate::bench::files::{MEASURE, MOST, RecordsError, Written};
use crate::bench::files::{check_count, read_json, read_lines, without_last_line, write_csv};
use crate::bench::rounds::{self, ROUNDS, RowKey, RowRounds};
use std::collections::HashMap;
use std::path::Path;

/// Reads `rows.csv`, or that file in the results folder `path`, with the `rounds.csv` beside it.
///
/// # Errors
/// Missing, malformed, cut or empty files, those that tell nowhere how many rows they have, those of another
/// [`SCHEMA`], figures that cannot be or are not those of their rounds, and rows of two runs of one scene.
pub fn read(path: &Path) -> Result<Vec<Row>, RecordsError> {
    let path = if path.is_dir() { path.join(ROWS) } else { path.to_owned() };
    let remedy = MEASURE;
    let bytes = read_lines(&path, remedy)?;
    let (lines, told) = without_last_line(&bytes);
    let mut rows = Vec::new();
    for row in csv::Reader::from_reader(lines).deserialize() {
        let row: Row =
            row.map_err(|source| RecordsError::Malformed { path: path.clone(), source, remedy })?;
        if row.schema != SCHEMA {
            return Err(RecordsError::Schema { path, found: row.schema, expected: SCHEMA, remedy });
        }
        let unusable = |value: f64| !(0.0..=MOST).contains(&value);
        let counts =
            [("width", row.width, [4, 8].contains(&row.width)), ("threads", row.threads, row.threads > 0)];
        let count =
            counts.into_iter().find(|(.., is_one)| !is_one).map(|(column, count, _)| (column, count.into()));
        let figure = row
            .figures()
            .into_iter()
            .find_map(|(column, value)| Some((column, value.filter(|&it| unusable(it))?)));
        if let Some((column, value)) = count.or(figure) {
            return Err(RecordsError::Figure {
                path,
                line: rows.len() + 2,
                column: column.into(),
                value,
                remedy,
            });
        }
        rows.push(row);
    }
    if rows.is_empty() {
        return Err(RecordsError::Empty { path, remedy });
    }
    // An environment tells of the files of its run, not of another CSV beside them.
    let is_of_run = path.file_name().is_some_and(|name| name == ROWS);
    let rounds_file = path.with_file_name(ROUNDS);
    let environment = if is_of_run || rounds_file.exists() { Ended::beside(&path)? } else { None };
    let written = environment.as_ref().and_then(|environment| environment.written);
    check_count(&path, rows.len(), told, written.filter(|_| is_of_run).map(|written| written.rows))?;
    let times = rounds::read(&rounds_file, written.map(|written| written.rounds))?;
    let mut by_round: HashMap<RowKey, RowRounds> = times.into_iter().collect();
    // Of a run under way, rounds may be newer than rows.
    let is_running = is_of_run && environment.is_some_and(|environment| environment.state == State::Running);
    for (i, row) in rows.iter_mut().enumerate().filter(|(_, row)| row.is_total()) {
        row.by_round = by_round.remove(&row.key()).unwrap_or_default();
        if !is_running {
            agreement::check_rounds(&path, i + 2, row)?;
        }
    }
    agreement::check_runs(&path, &rows)?;
    match by_round.keys().next().filter(|_| !is_running) {
        Some(key) => {
            let row = format!("{} {}/{}", key.scene, key.builder, key.width);
            Err(RecordsError::RowMissing { path, row })
        }
        None => Ok(rows),
    }
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

/// Writes `rows` to the folder: `rows.csv`, and `rounds.csv` where the times of rounds are known. The last line of each
/// tells how many it has.
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
    write_csv(path, rows)
}
