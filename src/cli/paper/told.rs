//! What an experiment leaves in its folder beside its records: findings and drawings.

use crate::bench::files::{text, write_whole};
use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::cli::verbs::plot::{check, draw};
use crate::report::plot::Drawing;
use crate::report::readme::findings::FINDINGS;
use std::path::Path;

/// Writes both to `folder` and prints the findings and the names of the drawings' files.
///
/// # Errors
/// An unwritable place.
pub fn write(findings: &str, drawings: &[Drawing], folder: &Path) -> Result<(), Failure> {
    write_whole(&folder.join(FINDINGS), findings.as_bytes())?;
    say(findings)?;
    let files = draw(drawings, folder)?;
    if files.is_empty() {
        return Ok(());
    }
    say(&files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>().join("\n"))
}

/// Fails if the findings or a drawing in `folder` are others.
///
/// # Errors
/// The first such file.
pub fn compare(findings: &str, drawings: &[Drawing], folder: &Path) -> Result<(), Failure> {
    let path = folder.join(FINDINGS);
    if text(&path).unwrap_or_default() != findings {
        let path = path.display();
        return Err(Failure::Wrong(format!(
            "{path}: not what these rows tell; write it again with --redraw"
        )));
    }
    check(drawings, folder)
}
