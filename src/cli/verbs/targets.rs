//! `phr targets`: what the builders are to reach, and what a run shows of it.

use crate::bench::results_dir;
use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::report::targets;
use std::path::PathBuf;

/// Print the targets of the builders, met or not, from results folders and their subfolders
///
/// Build and trace time against Embree's builders, memory, two threads against one (where there are rows of both),
/// growth (where there are scalable scenes). The exit code does not depend on the verdicts.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Results folders
    #[arg(required = true)]
    results: Vec<PathBuf>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (rows, is_complete) = results_dir::read_all(&arguments.results)?;
    say(&targets::document(&rows, is_complete))
}
