//! `phr table`: the table of a run, from its CSV.

use crate::bench::results_dir;
use crate::bench::row::{self, Row};
use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::report::figures::Under;
use crate::report::table;
use std::path::PathBuf;

/// Print the table of a results folder: Table 1 as in the paper, means beside the paper's, every scene
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Results folder, or a rows.csv
    results: PathBuf,
    /// Compare traces under embree-grafted, embree-native, phr, or each tree under its own [default:
    /// embree-grafted if the run has it, else own]
    #[arg(long, value_name = "KERNEL")]
    kernel: Option<String>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let rows = row::read(&arguments.results)?;
    let under = under(arguments.kernel.as_deref(), &rows)?;
    let complete = results_dir::is_complete(results_dir::environment(&arguments.results)?.as_ref());
    say(&table::document_under(&rows, complete, &under))
}

/// The choice of kernel that `--kernel` names, or the fairest.
pub fn under(kernel: Option<&str>, rows: &[Row]) -> Result<Under, Failure> {
    kernel.map_or_else(|| Ok(Under::best(rows)), |name| Under::by_name(name, rows).map_err(Failure::Bad))
}
