//! CSV files that are read back. Their last line, `# rows: 12`, tells how many rows stand above it: else a file that
//! was cut at a row's end would look whole. `rows.csv` and `rounds.csv` of older programs have none; their numbers
//! stand in `environment.json`.

use super::{MEASURE, MOST, RecordsError, TELL, read_lines, write_whole};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What the last line begins with.
const COUNT: &str = "# rows: ";

/// The last line of a file with so many rows.
pub fn last_line(rows: usize) -> String {
    format!("{COUNT}{rows}\n")
}

/// The lines of a file above its last one, and the number of rows which that one tells; all lines and `None` where it
/// tells none.
pub fn without_last_line(bytes: &[u8]) -> (&[u8], Option<usize>) {
    let split = || {
        let lines = bytes.strip_suffix(b"\n")?;
        let start = lines.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let (above, last) = bytes.split_at_checked(start)?;
        let rows = std::str::from_utf8(last).ok()?.trim_end().strip_prefix(COUNT)?.parse().ok()?;
        Some((above, Some(rows)))
    };
    split().unwrap_or((bytes, None))
}

/// Refuses a file of a run with other than the number of rows that its last line tells (`told`), or its environment
/// (`written`), and one of which neither tells any.
///
/// # Errors
/// [`RecordsError::Cut`], [`RecordsError::Uncounted`].
pub fn check_count(
    path: &Path,
    found: usize,
    told: Option<usize>,
    written: Option<usize>,
) -> Result<(), RecordsError> {
    let path = path.to_owned();
    if told.is_none() && written.is_none() {
        return Err(RecordsError::Uncounted { path, found });
    }
    match told.into_iter().chain(written).find(|count| *count != found) {
        Some(written) => Err(RecordsError::Cut { path, found, written, remedy: MEASURE }),
        None => Ok(()),
    }
}

/// Writes `rows` as CSV to the file `path`, whole or not at all.
///
/// # Errors
/// An unwritable place.
pub fn write_csv<T: Serialize>(path: &Path, rows: &[T]) -> Result<(), RecordsError> {
    let malformed = |source| RecordsError::Malformed { path: path.to_owned(), source, remedy: TELL };
    // Fields with a `#` are quoted: readers told to skip comments would end the row there.
    let mut writer = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(Vec::new());
    rows.iter().try_for_each(|row| writer.serialize(row)).map_err(malformed)?;
    let mut bytes = writer.into_inner().map_err(|error| malformed(csv::Error::from(error.into_error())))?;
    bytes.extend_from_slice(last_line(rows.len()).as_bytes());
    write_whole(path, &bytes)
}

/// Reads the rows of a CSV file, or of the file `name` in a folder; `schema` tells a row's, which is to be `expected`,
/// and `remedy` how to come by the file.
///
/// # Errors
/// No such file, other columns, no rows, fewer rows than the last line tells, figures that cannot be.
pub fn read_csv<T: for<'a> Deserialize<'a> + Serialize>(
    results: &Path,
    name: &str,
    (schema, expected): (impl Fn(&T) -> u32, u32),
    remedy: &'static str,
) -> Result<Vec<T>, RecordsError> {
    let path = if results.is_dir() { results.join(name) } else { results.to_owned() };
    let bytes = read_lines(&path, remedy)?;
    let (lines, written) = without_last_line(&bytes);
    let malformed = |source| RecordsError::Malformed { path: path.clone(), source, remedy };
    let mut reader = csv::Reader::from_reader(lines);
    let headers = reader.headers().map_err(malformed)?.clone();
    let mut rows: Vec<T> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(malformed)?;
        let row = record.deserialize(Some(&headers)).map_err(malformed)?;
        if let Some((column, value)) = absurd(&row, headers.iter().zip(&record)) {
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
    if let Some(found) = rows.iter().map(schema).find(|&found| found != expected) {
        return Err(RecordsError::Schema { path, found, expected, remedy });
    }
    let found = rows.len();
    match written {
        Some(written) if written == found => Ok(rows),
        Some(written) => Err(RecordsError::Cut { path, found, written, remedy }),
        None => Err(RecordsError::Unclosed { path, found, remedy }),
    }
}

/// The first number among the fields of a row that no figure can be: NaN, beyond [`MOST`], or negative, but for the
/// place of a plane. Fields that the row keeps as text are none, nor are coordinates of boxes, which are infinite
/// where a box is empty.
fn absurd<'a, T: Serialize>(
    row: &T,
    mut fields: impl Iterator<Item = (&'a str, &'a str)>,
) -> Option<(&'a str, f64)> {
    let row = serde_json::to_value(row).ok()?;
    fields.find_map(|(column, field)| {
        let value: f64 = field.parse().ok()?;
        let least = if column == "plane" { -MOST } else { 0.0 };
        let is_other = row.get(column).is_none_or(serde_json::Value::is_string)
            || column.starts_with("min_")
            || column.starts_with("max_");
        (!is_other && !(least..=MOST).contains(&value)).then_some((column, value))
    })
}

/// As [`read_csv`], of a file whose rows tell no schema.
///
/// # Errors
/// Those of [`read_csv`].
pub fn read_csv_file<T: for<'a> Deserialize<'a> + Serialize>(
    path: &Path,
    remedy: &'static str,
) -> Result<Vec<T>, RecordsError> {
    read_csv(path, "", (|_: &T| 0, 0), remedy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Line {
        name: String,
        ms: f64,
    }

    const REMEDY: &str = "measure again";

    fn written(names: &[&str]) -> (tempfile::TempDir, std::path::PathBuf, String) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lines.csv");
        let lines: Vec<Line> = names.iter().map(|name| Line { name: (*name).into(), ms: 1.5 }).collect();
        write_csv(&path, &lines).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        (folder, path, text)
    }

    fn read(path: &Path, text: &str) -> Result<Vec<Line>, String> {
        std::fs::write(path, text).unwrap();
        read_csv_file(path, REMEDY).map_err(|error| error.to_string())
    }

    #[test]
    fn the_last_line_tells_the_number_of_rows() {
        let (_keep, path, text) = written(&["a", "#b", "c\n# rows: 1\n"]);
        assert_eq!(text, "name,ms\na,1.5\n\"#b\",1.5\n\"c\n# rows: 1\n\",1.5\n# rows: 3\n");
        let names: Vec<String> = read(&path, &text).unwrap().into_iter().map(|line| line.name).collect();
        assert_eq!(names, ["a", "#b", "c\n# rows: 1\n"]);
        assert!(read(&path, &text.replace('\n', "\r\n")).is_ok(), "as some systems end lines");
    }

    #[test]
    fn figures_that_cannot_be_are_refused() {
        let (_keep, path, text) = written(&["a", "b"]);
        for figure in ["-1", "NaN", "inf", "1e308"] {
            let error = read(&path, &text.replacen("1.5", figure, 1)).unwrap_err();
            assert!(error.contains("lines.csv") && error.contains("ms"), "{error}");
        }
        #[derive(Debug, PartialEq, Serialize, Deserialize)]
        struct Box {
            min_x: f64,
            plane: f64,
            rays_per_s: f64,
        }
        let write = |rays_per_s| write_csv(&path, &[Box { min_x: -f64::INFINITY, plane: -2.0, rays_per_s }]);
        write(3.0).unwrap();
        assert_eq!(read_csv_file::<Box>(&path, REMEDY).unwrap()[0].plane, -2.0);
        write(-3.0).unwrap();
        assert!(read_csv_file::<Box>(&path, REMEDY).unwrap_err().to_string().contains("rays_per_s"));
    }

    #[test]
    fn every_cut_is_refused() {
        let (_keep, path, text) = written(&["a", "#b", "c\n# rows: 1\n", "d"]);
        for end in 0..text.len() {
            let error = read(&path, &text[..end]).unwrap_err();
            assert!(error.contains("lines.csv: ") && error.contains(REMEDY), "{error}");
            assert_eq!(error.lines().count(), 1, "{error}");
        }
    }

    #[test]
    fn what_is_missing_is_told_with_its_remedy() {
        let (_keep, path, text) = written(&["a", "b"]);
        let older = text.replace("# rows: 2\n", "");
        let error = read(&path, &older).unwrap_err();
        assert!(
            error.contains("no last line `# rows: N`") && error.contains("measure again; if its 2 "),
            "{error}"
        );
        assert_eq!(read(&path, &format!("{older}# rows: 2\n")).unwrap().len(), 2, "as the error tells");
        let error = read(&path, &text.replace("b,1.5\n", "")).unwrap_err();
        assert!(error.contains("1 rows, where 2 were written; fetch it again, or measure again"), "{error}");
        let error = read(&path, &format!("{text}{text}")).unwrap_err();
        assert!(error.contains("CSV"), "two files in one: {error}");
        for count in ["# rows: ", "# rows: two", "# rows: 2 3", "rows: 2", "# rows: -2"] {
            assert!(read(&path, &format!("{older}{count}\n")).is_err(), "{count}");
        }
    }
}
