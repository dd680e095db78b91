//! What the system tells of itself, in files and by its programs.

use std::process::Command;

/// What stands where the system does not tell.
pub const UNKNOWN: &str = "unknown";

/// The text of a file.
pub fn text(path: &str) -> String {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    if text.trim().is_empty() { UNKNOWN.into() } else { text.trim().into() }
}

/// The rest of the first line of a file that starts with `key`.
pub fn line_of(path: &str, key: &str) -> String {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let value = text.lines().find_map(|line| line.strip_prefix(key)).map(str::trim);
    value.unwrap_or(UNKNOWN).into()
}

/// What a program prints.
pub fn output(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).output().ok().filter(|output| output.status.success());
    let text = output.and_then(|output| String::from_utf8(output.stdout).ok()).unwrap_or_default();
    if text.trim().is_empty() { UNKNOWN.into() } else { text.trim().into() }
}
