//! `phr ablation`: builders relative to one of them.

use crate::bench::row;
use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::report::ablation::Ablation;
use std::path::PathBuf;

/// Print build time, SAH cost, EPO and trace time of builders relative to one of them, in the mean and by scene
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Results folder, or a rows.csv
    results: PathBuf,
    /// The builder that the others are compared with
    #[arg(long, value_name = "NAME")]
    base: String,
    /// The others
    #[arg(required = true, value_name = "NAME")]
    builders: Vec<String>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let rows = row::read(&arguments.results)?;
    let names: Vec<&str> = arguments.builders.iter().map(String::as_str).collect();
    let results = arguments.results.display();
    let told = |reason| Failure::Bad(format!("{results}: {reason}"));
    say(&Ablation::of(&rows, &arguments.base, &names).map_err(told)?.text())
}
