//! `phr report`: a run as one HTML file.

use crate::bench::files::write_whole;
use crate::bench::{results_dir, row};
use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::report::page::{PAGE, page};
use std::path::PathBuf;

/// Write a page about a results folder: verdict, plots, table, pictures and surroundings in one HTML file
///
/// The file needs no network and no other file. Heat maps (heat*.png, heatmaps/*.png), experiments (experiments/*.svg,
/// *.csv) and other figures in the folder are put into it.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Results folder, or a rows.csv
    results: PathBuf,
    /// File to write [default: report.html in the folder]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let results = &arguments.results;
    let rows = row::read(results)?;
    let folder = if results.is_dir() { results.clone() } else { results.with_file_name("") };
    // `.` has no name of its own.
    let folder = folder.canonicalize()?;
    let environment = results_dir::environment(&folder)?;
    let file = arguments
        .output
        .clone()
        .unwrap_or_else(|| if results.is_dir() { results.join(PAGE) } else { results.with_file_name(PAGE) });
    write_whole(&file, page(&rows, environment.as_ref(), &folder)?.as_bytes())?;
    say(&file.display().to_string())
}
