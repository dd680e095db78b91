//! The files of a results folder that are made from its rows when a run ends. Where other rows take the place of these, they
//! go too: no file of an older run may be taken for part of a new one.

use super::files::RecordsError;
use std::path::Path;

/// The table.
pub const TABLE: &str = "table1.md";
/// The page.
pub const PAGE: &str = "report.html";
/// The figures by name, each an SVG and a PNG.
pub const FIGURES: [&str; 7] =
    ["figure6", "figure6-own", "figure6-paper", "figure6-scenes", "growth", "threads", "phases"];

/// Removes `records`, files of an older run, from `folder`, and what was made of its rows.
///
/// # Errors
/// A file that cannot be removed.
pub fn remove(folder: &Path, records: &[&str]) -> Result<(), RecordsError> {
    let figures = FIGURES.iter().flat_map(|name| ["svg", "png"].map(|ending| format!("{name}.{ending}")));
    let made = records.iter().chain(&[TABLE, PAGE]).map(ToString::to_string).chain(figures);
    for path in made.map(|file| folder.join(file)).filter(|path| path.exists()) {
        let remedy = "remove it, or give another folder with --out";
        std::fs::remove_file(&path).map_err(|source| RecordsError::Io { path, source, remedy })?;
    }
    Ok(())
}
