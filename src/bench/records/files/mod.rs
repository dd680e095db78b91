//! The files of a results folder: read and written whole, each error with its file and remedy.

mod csv_rows;
mod held;

pub use csv_rows::{check_count, last_line, read_csv, read_csv_file, without_last_line, write_csv};
pub use held::hold;

use crate::bvh::saved::replace;
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::{Path, PathBuf};

/// What was written when a run ended, kept in `environment.json`: only there in runs of older programs, whose files
/// have no last line that tells it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Written {
    /// Rows of `rows.csv`.
    pub rows: usize,
    /// Lines of `rounds.csv` without its header.
    pub rounds: usize,
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
    /// Fewer or more rows than were written.
    #[error("{}: {found} rows, where {written} were written; fetch it again, or {remedy}", path.display())]
    Cut {
        /// The file.
        path: PathBuf,
        /// Rows in it.
        found: usize,
        /// Rows that were written.
        written: usize,
        /// The remedy.
        remedy: &'static str,
    },
    /// The last line does not tell the number of rows.
    #[error(
        "{}: no last line `# rows: N`, so it was cut or is of an older program; fetch it again, or {remedy}; if \
         its {found} rows are all, add the line `# rows: {found}`",
        path.display()
    )]
    Unclosed {
        /// The file.
        path: PathBuf,
        /// Rows in it.
        found: usize,
        /// The remedy.
        remedy: &'static str,
    },
    /// Neither the last line nor the environment tells the number of rows.
    #[error(
        "{}: no last line `# rows: N` nor an environment.json beside it that has the number as `written`, so it may \
         be cut; fetch both again; if its {found} rows are all, add the line `# rows: {found}`",
        path.display()
    )]
    Uncounted {
        /// The file.
        path: PathBuf,
        /// Rows in it.
        found: usize,
    },
    /// `rounds.csv` tells of a row that is not there.
    #[error("{}: no row of {row}, of which rounds.csv tells; fetch the folder again", path.display())]
    RowMissing {
        /// The file.
        path: PathBuf,
        /// Scene, builder and width.
        row: String,
    },
    /// A figure that is not that of its rounds.
    #[error(
        "{}: line {line}: {column} is {told}, but {of_rounds} by its rounds in rounds.csv; one of the two files was \
         changed: fetch both again, or measure again",
        path.display()
    )]
    Changed {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The column.
        column: String,
        /// What the row says.
        told: String,
        /// What its rounds say.
        of_rounds: f64,
    },
    /// Rows of a scene from two runs.
    #[error(
        "{}: line {line}: {scene} is of run {}, above of {}; keep each run in a folder of its own (`phr compare` \
         compares two, `phr merge` joins shards)",
        path.display(), runs[1], runs[0]
    )]
    TwoRuns {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The scene.
        scene: String,
        /// The runs, of the rows above and of this one.
        runs: [String; 2],
    },
    /// A figure that none can be.
    #[error("{}: line {line}: {column} is {value:e}; {remedy}", path.display())]
    Figure {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The column.
        column: String,
        /// Its value.
        value: f64,
        /// The remedy.
        remedy: &'static str,
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

/// Writes the file at `path`: at any time, also after a kill, it is the old file or the new one, whole.
///
/// # Errors
/// An unwritable place, or one that is no regular file.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), RecordsError> {
    replace(path, ".part", |file| file.write_all(bytes)).map_err(|source| {
        let remedy = "free space or make it writable, or name another place, as by --out or -o";
        RecordsError::Io { path: path.to_owned(), source, remedy }
    })
}
