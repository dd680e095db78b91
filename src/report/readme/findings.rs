//! What an experiment told of all its scenes together, out of the text beside its rows.

use crate::bench::files::{RecordsError, text};
use std::path::Path;

/// The text's file in a results folder.
pub const FINDINGS: &str = "findings.md";
/// The heading before single scenes.
pub const EVERY_SCENE: &str = "## Every scene";

/// The findings in `folder`, without their title and without single scenes, headings one level down.
///
/// # Errors
/// A file that cannot be read.
pub fn findings(folder: &Path) -> Result<String, RecordsError> {
    let path = folder.join(FINDINGS);
    let remedy = "run `phr experiment NAME --redraw`";
    let text = text(&path).map_err(|source| RecordsError::Io { path, source, remedy })?;
    Ok(told_of_all(&text))
}

fn told_of_all(text: &str) -> String {
    let without_title = text.split_once("\n\n").map_or("", |(_, rest)| rest);
    let told = without_title.split(EVERY_SCENE).next().unwrap_or("").trim_end();
    // Below a heading of the page.
    format!("\n{told}").replace("\n## ", "\n### ").trim_start().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn title_and_scenes_are_left_out() {
        let moving = "# animation\n\n## wrung\n\nA.\n\n## burst\n";
        assert_eq!(told_of_all(moving), "### wrung\n\nA.\n\n### burst");
        let text = format!("# grid\n\nMeans.\n\n| a |\n\n{EVERY_SCENE}\n\n| b |\n");
        assert_eq!(told_of_all(&text), "Means.\n\n| a |");
        let folder = tempfile::tempdir().unwrap();
        assert!(findings(folder.path()).unwrap_err().to_string().contains(FINDINGS));
        std::fs::write(folder.path().join(FINDINGS), text).unwrap();
        assert_eq!(findings(folder.path()).unwrap(), "Means.\n\n| a |");
    }
}
