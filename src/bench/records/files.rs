//! The files of a results folder: read and written whole, each error with its file and remedy.

use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::{Path, PathBuf};

/// What was written when a run ended, kept in `environment.json`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Written {
    /// Rows of `rows.csv`.
    pub rows: usize,
    /// Lines of `rounds.csv` without its header.
    pub rounds: usize,
    /// Rows of `phases.csv`; older runs do not tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phases: Option<usize>,
}

/// No figure is larger: as milliseconds, thirty thousand years.
pub const MOST: f64 = 1e15;

/// Makes a folder for records, if there is none yet.
///
/// # Errors
/// An unwritable place.
pub fn new_folder(folder: &Path) -> Result<(), RecordsError> {
    std::fs::create_dir_all(folder).map_err(|source| RecordsError::Io {
        path: folder.to_owned(),
        source,
        remedy: "give a writable folder, as by --out",
    })
}

/// How to come by the files of a run.
pub const MEASURE: &str = "give a results folder written by `phr bench`, or run that again";
/// What can be done about a value that this program cannot write.
pub const TELL: &str = "report this with the command";

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
    #[error("{}: {source}; {remedy}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The place and the reason.
        source: csv::Error,
        /// The remedy.
        remedy: &'static str,
    },
    /// The file has no rows.
    #[error("{}: no rows; {remedy}", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
        /// The remedy.
        remedy: &'static str,
    },
    /// A file that does not end with a line's end.
    #[error("{}: ends within a line, it was cut; fetch it again, or {remedy}", path.display())]
    Unended {
        /// The file.
        path: PathBuf,
        /// The remedy.
        remedy: &'static str,
    },
    /// Fewer or more lines than the run wrote.
    #[error(
        "{}: {found} rows, where its run wrote {written}; fetch the folder again or run `phr bench` again",
        path.display()
    )]
    Cut {
        /// The file.
        path: PathBuf,
        /// Rows in it.
        found: usize,
        /// Rows that were written.
        written: usize,
    },
    /// `rounds.csv` tells of a row that is not there.
    #[error("{}: no row of {row}, of which rounds.csv tells; fetch the folder again", path.display())]
    RowMissing {
        /// The file.
        path: PathBuf,
        /// Scene, builder and width.
        row: String,
    },
    /// A figure that none can be.
    #[error("{}: line {line}: {column} is {value:e}; run `phr bench` again", path.display())]
    Figure {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The column.
        column: String,
        /// Its value.
        value: f64,
    },
    /// Written with other columns.
    #[error("{}: schema {found}, this program reads {expected}; {remedy}", path.display())]
    Schema {
        /// The file.
        path: PathBuf,
        /// Its schema.
        found: u32,
        /// The schema of this program.
        expected: u32,
        /// The remedy.
        remedy: &'static str,
    },
    /// The file is not JSON of the expected content.
    #[error("{}: {source}; {remedy}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// The place and the reason.
        source: serde_json::Error,
        /// The remedy.
        remedy: &'static str,
    },
}

/// Reads a JSON file; `remedy` tells what to do without it.
///
/// # Errors
/// No such file, or no such content.
pub fn read_json<T: for<'a> Deserialize<'a>>(path: &Path, remedy: &'static str) -> Result<T, RecordsError> {
    let bytes = read(path, remedy)?;
    serde_json::from_slice(&bytes).map_err(|source| RecordsError::Json {
        path: path.to_owned(),
        source,
        remedy,
    })
}

/// Reads a text file, refusing one that ends within a line: its last row may be half a row.
///
/// # Errors
/// No such file, or a cut one.
pub fn read_lines(path: &Path, remedy: &'static str) -> Result<Vec<u8>, RecordsError> {
    let bytes = read(path, remedy)?;
    // A quoted field may hold a line's end.
    let is_quoted = bytes.iter().filter(|byte| **byte == b'"').count() % 2 == 1;
    match bytes.last() {
        None => Ok(bytes),
        Some(b'\n') if !is_quoted => Ok(bytes),
        Some(_) => Err(RecordsError::Unended { path: path.to_owned(), remedy }),
    }
}

fn read(path: &Path, remedy: &'static str) -> Result<Vec<u8>, RecordsError> {
    content(path).map_err(|source| RecordsError::Io { path: path.to_owned(), source, remedy })
}

/// The content of a regular file; a pipe or a device might never end.
///
/// # Errors
/// No such file, or one that cannot be read.
pub fn content(path: &Path) -> std::io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, "not a regular file"));
    }
    std::fs::read(path)
}

/// The same of a text.
///
/// # Errors
/// The same, or bytes that are no UTF-8.
pub fn text(path: &Path) -> std::io::Result<String> {
    String::from_utf8(content(path)?)
        .map_err(|error| std::io::Error::new(std::io::ErrorKind::InvalidData, error.utf8_error()))
}

/// Writes `value` as JSON to the file `path`, whole or not at all.
///
/// # Errors
/// An unwritable place.
pub fn write_json<T: Serialize>(path: &Path, value: &T) -> Result<(), RecordsError> {
    let mut bytes = serde_json::to_vec_pretty(value).map_err(|source| RecordsError::Json {
        path: path.to_owned(),
        source,
        remedy: TELL,
    })?;
    bytes.push(b'\n');
    write_whole(path, &bytes)
}

/// Writes `rows` as CSV to the file `path`, whole or not at all.
///
/// # Errors
/// An unwritable place.
pub fn write_csv<T: Serialize>(path: &Path, rows: &[T]) -> Result<(), RecordsError> {
    let malformed = |source| RecordsError::Malformed { path: path.to_owned(), source, remedy: TELL };
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.iter().try_for_each(|row| writer.serialize(row)).map_err(malformed)?;
    let bytes = writer.into_inner().map_err(|error| malformed(csv::Error::from(error.into_error())))?;
    write_whole(path, &bytes)
}

/// Reads the rows of a CSV file, or of the file `name` in a folder; `schema` tells a row's, which is to be `expected`,
/// and `remedy` how to come by the file.
///
/// # Errors
/// No such file, other columns, no rows, figures that cannot be.
pub fn read_csv<T: for<'a> Deserialize<'a> + Serialize>(
    results: &Path,
    name: &str,
    (schema, expected): (impl Fn(&T) -> u32, u32),
    remedy: &'static str,
) -> Result<Vec<T>, RecordsError> {
    let path = if results.is_dir() { results.join(name) } else { results.to_owned() };
    let bytes = read_lines(&path, remedy)?;
    let malformed = |source| RecordsError::Malformed { path: path.clone(), source, remedy };
    let mut reader = csv::Reader::from_reader(&bytes[..]);
    let headers = reader.headers().map_err(malformed)?.clone();
    let mut rows: Vec<T> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(malformed)?;
        let row = record.deserialize(Some(&headers)).map_err(malformed)?;
        if let Some((column, value)) = absurd(&row, headers.iter().zip(&record)) {
            return Err(RecordsError::Figure { path, line: rows.len() + 2, column: column.into(), value });
        }
        rows.push(row);
    }
    if rows.is_empty() {
        return Err(RecordsError::Empty { path, remedy });
    }
    match rows.iter().map(schema).find(|&found| found != expected) {
        Some(found) => Err(RecordsError::Schema { path, found, expected, remedy }),
        None => Ok(rows),
    }
}

/// The first number among the fields of a row that no figure can be: NaN, beyond [`MOST`], or a negative time
/// (`ms`). Fields that the row keeps as text are none, nor are coordinates of boxes, which are infinite where a box
/// is empty.
fn absurd<'a, T: Serialize>(
    row: &T,
    mut fields: impl Iterator<Item = (&'a str, &'a str)>,
) -> Option<(&'a str, f64)> {
    let row = serde_json::to_value(row).ok()?;
    fields.find_map(|(column, field)| {
        let value: f64 = field.parse().ok()?;
        let least = if column.split('_').any(|word| word == "ms") { 0.0 } else { -MOST };
        let is_other = row.get(column).is_none_or(serde_json::Value::is_string)
            || column.starts_with("min_")
            || column.starts_with("max_");
        (!is_other && !(least..=MOST).contains(&value)).then_some((column, value))
    })
}

/// As [`read_csv`], of a file whose rows tell no schema.
///
/// # Errors
/// No such file, other columns, no rows, figures that cannot be.
pub fn read_csv_file<T: for<'a> Deserialize<'a> + Serialize>(
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
    write().map_err(|source| {
        // On a full disk what was written of it would only be in the way. That it cannot be removed is no news.
        let _ = std::fs::remove_file(&part);
        let remedy = "free space or make it writable, or name another place, as by --out or -o";
        RecordsError::Io { path: path.to_owned(), source, remedy }
    })
}
