//! The files of a results folder: read and written whole, each error with its file and remedy.

use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Why records could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum RecordsError {
    /// The file cannot be opened, read or written.
    #[error("{}: {source}; {remedy}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The system's message.
        source: std::io::Error,
        /// The remedy.
        remedy: &'static str,
    },
    /// The file is not CSV of this schema.
    #[error("{}: {source}; give a results folder written by `phr bench`", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The place and the reason.
        source: csv::Error,
    },
    /// The file has no rows.
    #[error("{}: no rows; run `phr bench` again", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// Written with other columns.
    #[error("{}: schema {found}, this program reads {expected}; run `phr bench` again", path.display())]
    Schema {
        /// The file.
        path: PathBuf,
        /// Its schema.
        found: u32,
        /// The schema of this program.
        expected: u32,
    },
    /// The file is not JSON of the expected content.
    #[error("{}: {source}; remove the folder or run without --resume", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// The place and the reason.
        source: serde_json::Error,
    },
}

/// Reads a JSON file of a results folder.
///
/// # Errors
/// No such file, or no such content.
pub fn read_json<T: for<'a> Deserialize<'a>>(path: &Path) -> Result<T, RecordsError> {
    let bytes = std::fs::read(path).map_err(|source| RecordsError::Io {
        path: path.to_owned(),
        source,
        remedy: "there is no run to resume; run without --resume",
    })?;
    serde_json::from_slice(&bytes).map_err(|source| RecordsError::Json { path: path.to_owned(), source })
}

/// Writes `value` as JSON to the file `path`, whole or not at all.
///
/// # Errors
/// An unwritable place.
pub fn write_json<T: Serialize>(path: &Path, value: &T) -> Result<(), RecordsError> {
    let mut bytes = serde_json::to_vec_pretty(value)
        .map_err(|source| RecordsError::Json { path: path.to_owned(), source })?;
    bytes.push(b'\n');
    write_whole(path, &bytes)
}

/// Writes `rows` as CSV to the file `path`, whole or not at all.
///
/// # Errors
/// An unwritable place.
pub fn write_csv<T: Serialize>(path: &Path, rows: &[T]) -> Result<(), RecordsError> {
    let malformed = |source| RecordsError::Malformed { path: path.to_owned(), source };
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.iter().try_for_each(|row| writer.serialize(row)).map_err(malformed)?;
    let bytes = writer.into_inner().map_err(|error| malformed(csv::Error::from(error.into_error())))?;
    write_whole(path, &bytes)
}

/// Reads the rows of a CSV file, or of the file `name` in a folder; `schema` tells a row's, which is to be `expected`,
/// and `remedy` how to come by the file.
///
/// # Errors
/// No such file, other columns, no rows.
pub fn read_csv<T: for<'a> Deserialize<'a>>(
    results: &Path,
    name: &str,
    (schema, expected): (impl Fn(&T) -> u32, u32),
    remedy: &'static str,
) -> Result<Vec<T>, RecordsError> {
    let path = if results.is_dir() { results.join(name) } else { results.to_owned() };
    let bytes =
        std::fs::read(&path).map_err(|source| RecordsError::Io { path: path.clone(), source, remedy })?;
    let malformed = |source| RecordsError::Malformed { path: path.clone(), source };
    let rows: Vec<T> =
        csv::Reader::from_reader(&bytes[..]).deserialize().collect::<Result<_, _>>().map_err(malformed)?;
    if rows.is_empty() {
        return Err(RecordsError::Empty { path });
    }
    match rows.iter().map(schema).find(|&found| found != expected) {
        Some(found) => Err(RecordsError::Schema { path, found, expected }),
        None => Ok(rows),
    }
}

/// As [`read_csv`], of a file whose rows tell no schema.
///
/// # Errors
/// No such file, other columns, no rows.
pub fn read_csv_file<T: for<'a> Deserialize<'a>>(
    path: &Path,
    remedy: &'static str,
) -> Result<Vec<T>, RecordsError> {
    read_csv(path, "", (|_: &T| 0, 0), remedy)
}

/// Writes a file beside `path` and renames it: at any time, also after a kill, `path` is the old file or the new
/// one, whole.
///
/// # Errors
/// An unwritable place.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), RecordsError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let part = path.with_file_name(name);
    let write = || {
        let mut file = std::fs::File::create(&part)?;
        file.write_all(bytes)?;
        file.sync_data()?;
        std::fs::rename(&part, path)
    };
    write().map_err(|source| RecordsError::Io {
        path: path.to_owned(),
        source,
        remedy: "give a writable folder with --out",
    })
}
