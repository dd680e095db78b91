//! `phr report`: a run as one HTML file.

use crate::bench::files::write_whole;
use crate::bench::results_dir::PAGE;
use crate::bench::{results_dir, row};
use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::cli::place::{FileKind, check_place};
use crate::report::page::page;
use std::path::{Path, PathBuf};

/// Write a page about a results folder: verdict, plots, table, pictures and surroundings in one HTML file
///
/// The file needs no network and no other file. Heat maps (heat*.png, heatmaps/*.png), experiments
/// (experiments/*.svg, *.csv, *.md, and experiments/NAME/ likewise) and other figures in the folder are put into
/// it, and with --experiments those of other folders: `phr experiment` writes to results/experiments.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Results folder, or a rows.csv
    results: PathBuf,
    /// Folder with experiments (*.svg, *.csv, *.md, and NAME/ likewise) and heat maps (heat*.png, heatmaps/*.png)
    /// for the page (repeatable)
    #[arg(long, value_name = "DIR")]
    experiments: Vec<PathBuf>,
    /// File to write [default: report.html in the folder]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let results = &arguments.results;
    let beside = |file| if results.is_dir() { results.join(file) } else { results.with_file_name(file) };
    let file = arguments.output.clone().unwrap_or_else(|| beside(PAGE));
    if let Some(folder) = arguments.experiments.iter().find(|folder| !folder.is_dir()) {
        let folder = folder.display();
        return Err(Failure::Bad(format!(
            "--experiments {folder}: no such folder; give one that `phr experiment` wrote to, as results/experiments"
        )));
    }
    check_place(&file, FileKind::Html)?;
    write_page(results, &arguments.experiments, &file)?;
    say(&file.display().to_string())
}

/// Writes the page about `results`, a folder or its rows, with what lies in folders of `experiments`, to `file`.
///
/// # Errors
/// Those of reading the folder, and an unwritable place.
pub fn write_page(results: &Path, experiments: &[PathBuf], file: &Path) -> Result<(), Failure> {
    let rows = row::read(results)?;
    // A folder such as `.` has its name from the place where it is.
    let place = results.canonicalize()?;
    let folder = if place.is_dir() { place.as_path() } else { place.parent().unwrap_or(&place) };
    let environment = results_dir::environment(folder)?;
    let page = page(&rows, environment.as_ref(), folder, experiments)?;
    Ok(write_whole(file, page.as_bytes())?)
}
