//! `phr merge`: the shards of a run as one.

use crate::bench::made_of_rows::PAGE;
use crate::bench::{merge, row};
use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::cli::verbs::pages::made_of_rows;
use std::path::PathBuf;

/// Merge the shards of a run (`phr bench --shard K/N`) into rows, table, plots and page; those of unlike machines apart
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The run's results folder, which has the folder shards
    results: PathBuf,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let folders = merge::merge(&arguments.results)?;
    for folder in &folders {
        let rows = row::read(folder)?;
        made_of_rows(&rows, true, folder)?;
        say(&folder.join(PAGE).display().to_string())?;
    }
    if let [first, second, ..] = &folders[..] {
        let (first, second) = (first.display(), second.display());
        say(&format!(
            "The machines are unlike, so that times are not averaged; compare them: phr compare {first} {second}"
        ))?;
    }
    Ok(())
}
