//! What commands tell besides.

use std::io::Write;

/// Prints a line to standard error, after the program's name. That nobody reads it is no error.
pub fn note(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "phr: {text}");
}
