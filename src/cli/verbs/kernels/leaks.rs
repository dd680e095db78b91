//! `phr leaks`: rays aimed at the vertices and edges of a closed mesh from within, and how many get out.

use crate::bench::kernels::leaks::{self, LEAKS, LeakSettings};
use crate::bench::settings::MOST_THREADS;
use crate::cli::failure::Failure;
use crate::cli::options;
use crate::cli::output::say;
use crate::cli::place::results_place;
use crate::report::kernels::leaks_table;
use std::path::PathBuf;

/// Count the rays that leave a closed sphere through its vertices and edges, by Embree's kernels and ours, into
/// DIR/leaks.csv
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Rays by the watertight kernel over each tree, half of them at vertices, half at edges; the others get a tenth
    #[arg(long, default_value = "100M", value_name = "N", value_parser = options::rays)]
    rays: f64,
    /// Threads [default: all]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Folder of the results
    #[arg(long, default_value = "results/leaks", value_name = "DIR")]
    out: PathBuf,
    /// Replace the results of an earlier run in the folder
    #[arg(long)]
    replace: bool,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let threads = arguments.threads.unwrap_or_else(options::all_threads);
    if !(1..=MOST_THREADS).contains(&threads) {
        return Err(Failure::Bad(format!("--threads {threads}: give 1 to {MOST_THREADS}")));
    }
    results_place(&arguments.out.join(LEAKS), arguments.replace)?;
    let rows =
        leaks::measure(&LeakSettings { rays: arguments.rays as u64, threads }).map_err(Failure::Bad)?;
    leaks::write(&arguments.out.join(LEAKS), &rows)?;
    say(&leaks_table(&rows))?;
    match rows.iter().filter(|row| row.is_watertight()).map(|row| row.leaks).sum::<u64>() {
        0 => Ok(()),
        leaks => Err(Failure::Wrong(format!("the watertight kernel lets {leaks} rays through"))),
    }
}
