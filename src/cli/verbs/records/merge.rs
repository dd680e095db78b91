//! `phr merge`: the shards of a run as one.

use crate::bench::files::write_whole;
use crate::bench::merge::{self, MACHINES};
use crate::bench::results_dir::PAGE;
use crate::bench::{results_dir, row};
use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::cli::verbs::pages::made_of_rows;
use crate::report::compare::machines::{COMPARED, compared};
use std::path::PathBuf;

/// Merge the shards of a run (`phr bench --shard K/N`) into rows, table, plots and page; those of unlike machines
/// apart, with a table that compares each machine's trees
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The run's results folder, which has the folder shards
    results: PathBuf,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut machines = Vec::new();
    for folder in merge::merge(&arguments.results)? {
        let rows = row::read(&folder)?;
        made_of_rows(&rows, true, &folder)?;
        say(&folder.join(PAGE).display().to_string())?;
        let machine = results_dir::environment(&folder)?.map(|environment| environment.machine);
        let words = machine.map(|machine| format!("{}, {} processors", machine.cpu, machine.processors));
        machines.push((words.unwrap_or_default(), rows));
    }
    if machines.len() > 1 {
        let file = arguments.results.join(MACHINES).join(COMPARED);
        let text = compared(&machines);
        write_whole(&file, text.as_bytes())?;
        say(&format!("{}\n\n{text}", file.display()))?;
    }
    Ok(())
}
