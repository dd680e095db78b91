//! Places of the files that commands write: nothing is lost there.

use super::failure::Failure;
use crate::bench::files::new_folder;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A kind of file that a command writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A picture.
    Png,
    /// A saved tree.
    Tree,
    /// A configuration.
    Json,
    /// A page.
    Html,
}

impl FileKind {
    /// How its files begin, and what they are called.
    fn signature(self) -> (&'static [u8], &'static str) {
        match self {
            Self::Png => (b"\x89PNG", "PNG image"),
            Self::Tree => (b"PHRTREE\0", "saved tree"),
            Self::Json => (b"{", "configuration in JSON"),
            Self::Html => (b"<!doctype html>", "HTML page"),
        }
    }
}

/// Refuses a place for a file that cannot be written, or where a file of another kind lies, as the scene that is read,
/// before any work is done.
///
/// # Errors
/// A folder, a place in none, or a file that is no older one of `kind`.
pub fn check_place(path: &Path, kind: FileKind) -> Result<(), Failure> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if path.is_dir() {
        return Err(Failure::Bad(format!("{}: is a directory; give a file name", path.display())));
    }
    if !folder.is_dir() {
        let (path, folder) = (path.display(), folder.display());
        return Err(Failure::Bad(format!("{path}: no such folder as {folder}; make it first")));
    }
    let (begin, name) = kind.signature();
    let mut found = Vec::new();
    if path.is_file() {
        let file = File::open(path).and_then(|file| file.take(begin.len() as u64).read_to_end(&mut found));
        file.map_err(|error| Failure::Bad(format!("{}: {error}; give another name", path.display())))?;
    }
    if !found.is_empty() && found != begin {
        let path = path.display();
        return Err(Failure::Bad(format!("{path}: is there, and no {name}; remove it or give another name")));
    }
    Ok(())
}

/// Refuses to write over the results in `csv` unless they are to be replaced, before any work is done; makes their
/// folder.
///
/// # Errors
/// Results that are there, a folder that cannot be made.
pub fn results_place(csv: &Path, replace: bool) -> Result<(), Failure> {
    if csv.exists() && !replace {
        let csv = csv.display();
        return Err(Failure::Bad(format!(
            "{csv}: is there already; --replace puts new results in its place, --out gives another folder"
        )));
    }
    Ok(csv.parent().map_or(Ok(()), new_folder)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_another_kind_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        let refused = |kind| match check_place(&path, kind) {
            Err(Failure::Bad(text)) => {
                text.contains("x: is there, and no ") && text.contains("; remove it or")
            }
            other => panic!("{other:?}"),
        };
        for (content, kind) in [
            ("", None),
            ("v 0 0 0\n", None),
            ("{\"name\": 1}", Some(FileKind::Json)),
            ("<!doctype html>\n<html>", Some(FileKind::Html)),
        ] {
            std::fs::write(&path, content).unwrap();
            for other in [FileKind::Png, FileKind::Tree, FileKind::Json, FileKind::Html] {
                let is_right = content.is_empty() || kind == Some(other);
                assert!(
                    if is_right { check_place(&path, other).is_ok() } else { refused(other) },
                    "{content}"
                );
            }
        }
        std::fs::remove_file(&path).unwrap();
        assert!(check_place(&path, FileKind::Tree).is_ok());
        assert!(check_place(folder.path(), FileKind::Tree).is_err());
    }
}
