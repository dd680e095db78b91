//! The command line: one file per verb. Bad input ends in one line on stderr and exit code 2, wrong hits and
//! failed checks in exit code 1, an undecided comparison in 3, Ctrl-C in 130.

mod ablation;
mod bench;
mod build;
mod compare;
mod plot;
mod progress;
mod readme;
mod reduce;
mod render;
mod scenes;
mod table;
mod targets;
mod verify;

use crate::bench::contender::{self, Cell, Pools};
use clap::{Parser, Subcommand};
use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

/// Progressive Hierarchical Refinement: BVH builders, measured beside Embree's with the same rays.
#[derive(Debug, Parser)]
#[command(name = "phr", version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Bench(bench::Arguments),
    Build(build::Arguments),
    Render(render::Arguments),
    Verify(verify::Arguments),
    Scenes(scenes::Arguments),
    Table(table::Arguments),
    Plot(plot::Arguments),
    #[command(alias = "bars")]
    Targets(targets::Arguments),
    Ablation(ablation::Arguments),
    Compare(compare::Arguments),
    Reduce(reduce::Arguments),
    Readme(readme::Arguments),
}

/// Why a command did not succeed.
#[derive(Debug)]
enum Failure {
    /// The input cannot be used, or the output not be written: exit code 2.
    Bad(String),
    /// Hits are wrong, a builder failed, a comparison or a check did: exit code 1.
    Wrong(String),
    /// A comparison decides nothing: exit code 3.
    Inconclusive(String),
    /// Stopped by the user: exit code 130.
    Interrupted(String),
}

impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Bad(error.to_string())
    }
}

/// Runs the command that the process was started with.
pub fn main() -> ExitCode {
    run(std::env::args_os())
}

/// Runs the command given by `arguments`, the program's name first.
pub fn run(arguments: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> ExitCode {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version come this way too, with code 0. Nothing is left to do if they cannot be shown.
            let _ = error.print();
            return ExitCode::from(error.exit_code() as u8);
        }
    };
    let result = match &arguments.verb {
        Verb::Bench(arguments) => bench::run(arguments),
        Verb::Build(arguments) => build::run(arguments),
        Verb::Render(arguments) => render::run(arguments),
        Verb::Verify(arguments) => verify::run(arguments),
        Verb::Scenes(arguments) => scenes::run(arguments),
        Verb::Table(arguments) => table::run(arguments),
        Verb::Plot(arguments) => plot::run(arguments),
        Verb::Targets(arguments) => targets::run(arguments),
        Verb::Ablation(arguments) => ablation::run(arguments),
        Verb::Reduce(arguments) => reduce::run(arguments),
        Verb::Compare(arguments) => compare::run(arguments),
        Verb::Readme(arguments) => readme::run(arguments),
    };
    let (text, code) = match result {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Bad(text)) => (text, 2),
        Err(Failure::Wrong(text)) => (text, 1),
        Err(Failure::Inconclusive(text)) => (text, 3),
        Err(Failure::Interrupted(text)) => (text, 130),
    };
    // One line, whatever a library wrote into its message.
    eprintln!("phr: {}", text.split_whitespace().collect::<Vec<_>>().join(" "));
    ExitCode::from(code)
}

/// Prints to standard output. A reader that went away (`phr table | head`) is no error.
fn say(text: &str) -> Result<(), Failure> {
    match writeln!(std::io::stdout().lock(), "{}", text.strip_suffix('\n').unwrap_or(text)) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Bad(format!("standard output: {error}; free the disk or give another place")))
        }
        _ => Ok(()),
    }
}

/// Threads of this machine.
fn all_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// The pool of `threads`, for verbs that take them from the user.
fn pools(threads: usize) -> Result<Pools, Failure> {
    if threads == 0 {
        return Err(Failure::Bad("--threads 0: nothing could run; give 1 or more".into()));
    }
    let build = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = build.map_err(|error| Failure::Bad(format!("--threads {threads}: {error}; give fewer")))?;
    Ok(pool.into())
}

/// The cell of `builder` at `width`, or at its only or smallest one.
fn cell(builder: &str, width: Option<u32>) -> Result<Cell, Failure> {
    let cells = contender::cells(false);
    let of_builder: Vec<&Cell> = cells.iter().filter(|cell| cell.builder == builder).collect();
    if of_builder.is_empty() {
        let mut known: Vec<&str> = cells.iter().map(|cell| cell.builder.as_str()).collect();
        known.dedup();
        return Err(Failure::Bad(format!("no builder is called {builder}; there are {}", known.join(", "))));
    }
    let found = of_builder.iter().find(|cell| width.is_none_or(|width| cell.width == width));
    let no_width = || {
        let widths: Vec<String> = of_builder.iter().map(|cell| cell.width.to_string()).collect();
        let width = width.unwrap_or_default();
        Failure::Bad(format!("--width {width}: {builder} builds trees of width {}", widths.join(" and ")))
    };
    found.map(|&cell| cell.clone()).ok_or_else(no_width)
}
