//! `phr reduce`: the rows of a run that a repository keeps.

use crate::bench::results_dir;
use crate::cli::failure::Failure;
use crate::cli::output::say;
use std::path::PathBuf;

/// Write the sums over views and kinds of rays of a results folder and its subfolders to another: small enough to
/// commit
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Results folder
    results: PathBuf,
    /// Folder to write rows.csv and environment.json to
    out: PathBuf,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let written = results_dir::reduce(&arguments.results, &arguments.out)?;
    let lines: Vec<String> = written.iter().map(|folder| folder.display().to_string()).collect();
    say(&lines.join("\n"))
}
