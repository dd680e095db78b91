//! What commands print.

use super::failure::Failure;
use std::io::Write;

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
