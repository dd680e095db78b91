//! `phr table`: the table of a run, from its CSV.

use super::{Failure, say};
use crate::bench::environment::{ENVIRONMENT, Environment, State};
use crate::bench::records;
use crate::bench::samples::read_json;
use crate::report::table;
use std::path::PathBuf;

/// Print the table of a results folder
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Results folder, or a rows.csv
    results: PathBuf,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let rows = records::read(&arguments.results)?;
    // A lone CSV tells of unfinished cells by its warnings; the environment tells of missing ones too.
    let environment = arguments.results.join(ENVIRONMENT);
    let complete = !environment.is_file()
        || read_json::<Environment>(&environment).map_or(true, |found| found.state == State::Complete);
    say(&table::document(&rows, complete))
}
