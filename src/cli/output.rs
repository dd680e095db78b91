//! What commands print.

use super::failure::Failure;
use std::io::Write;
use std::path::Path;

/// Prints to standard output. A closed pipe (`phr table | head`) is no error.
///
/// # Errors
/// Any other failure to write.
pub fn say(text: &str) -> Result<(), Failure> {
    match writeln!(std::io::stdout().lock(), "{}", text.strip_suffix('\n').unwrap_or(text)) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Bad(format!("standard output: {error}; free the disk or give another place")))
        }
        _ => Ok(()),
    }
}

/// Refuses a place that cannot be written before any work is done.
///
/// # Errors
/// A folder, or a place in none.
pub fn check_place(path: &Path) -> Result<(), Failure> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if path.is_dir() {
        return Err(Failure::Bad(format!("{}: is a directory; give a file name", path.display())));
    }
    if !folder.is_dir() {
        return Err(Failure::Bad(format!("{}: no such folder; make it first", folder.display())));
    }
    Ok(())
}

/// Makes a folder for results, if there is none yet.
///
/// # Errors
/// An unwritable place.
pub fn new_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| {
        Failure::Bad(format!("{}: {error}; give a writable folder with --out", folder.display()))
    })
}
