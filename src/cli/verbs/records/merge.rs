//! `phr merge`: the shards of a run as one.

use crate::bench::files::write_whole;
use crate::bench::phases;
use crate::bench::{merge, row};
use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::cli::run_summary::TABLE;
use crate::cli::verbs::plot::draw;
use crate::report::figures::Under;
use crate::report::{plot, table};
use std::path::PathBuf;

/// Merge the shards of a run (`phr bench --shard K/N`) into rows, table and plots; those of unlike machines apart
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
        write_whole(&folder.join(TABLE), table::document(&rows, true).as_bytes())?;
        draw(&plot::figures(&rows, &phases::read(folder)?, &Under::best(&rows)), folder)?;
        say(&folder.display().to_string())?;
    }
    if let [first, second, ..] = &folders[..] {
        let (first, second) = (first.display(), second.display());
        say(&format!(
            "The machines are unlike, so that times are not averaged; compare them: phr compare {first} {second}"
        ))?;
    }
    Ok(())
}
