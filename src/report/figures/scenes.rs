//! The scenes of some rows.

use crate::bench::row::Row;

/// The scenes of `rows`, in their order.
pub fn scenes(rows: &[Row]) -> Vec<String> {
    scenes_of(rows.iter().map(|row| &row.scene))
}

/// The names of scenes, each once, in their order.
pub fn scenes_of<'a>(of_rows: impl IntoIterator<Item = &'a String>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in of_rows {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}
