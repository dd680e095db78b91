//! `phr readme`: regenerates the figures in Markdown files from committed rows.

use crate::bench::files::{text, write_whole};
use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::report::readme::{differences, regenerate};
use std::path::{Path, PathBuf};

/// Regenerate the figures between markers in Markdown files from the rows that the markers name
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Markdown files
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Write nothing; show the differences and fail if there are any
    #[arg(long)]
    check: bool,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut stale = Vec::new();
    for path in &arguments.files {
        let name = path.display();
        let text =
            text(path).map_err(|error| Failure::Bad(format!("{name}: {error}; give Markdown files")))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let new = regenerate(&text, folder).map_err(|error| Failure::Bad(format!("{name}: {error}")))?;
        if new == text {
            continue;
        }
        if arguments.check {
            say(&format!("{name}:\n{}", differences(&text, &new)))?;
            stale.push(name.to_string());
        } else {
            write_whole(path, new.as_bytes())?;
            say(&format!("{name}: written"))?;
        }
    }
    if stale.is_empty() {
        return Ok(());
    }
    Err(Failure::Wrong(format!("{}: not the figures of the rows; run `phr readme`", stale.join(", "))))
}
