//! The command line: one file per verb. Bad input ends in one line on stderr and exit code 2, wrong hits and
//! failed checks in exit code 1, an undecided comparison in 3, Ctrl-C in 130.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod failure;
mod measuring;
mod note;
mod options;
mod output;
mod paper;
mod place;
mod plan_outline;
mod progress;
mod run_summary;
mod verbs;

use crate::bench::planned_scene::limit;
use crate::memory::catch_out_of_memory;
use crate::scene::Limits;
use clap::error::ErrorKind;
use clap::{Parser, Subcommand};
use paper::{animate, arguments, experiment, heatmap};
use std::ffi::OsString;
use std::process::ExitCode;
use verbs::{
    ablation, advise, advise::tune, bench, build, child::memory, child::turns, compare, kernels,
    kernels::leaks, pages, pages::table, plot, records::merge, records::reduce, render, scaling, scenes,
    targets, verify,
};

/// Progressive Hierarchical Refinement: BVH builders, measured beside Embree's with the same rays.
#[derive(Debug, Parser)]
#[command(name = "phr", version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
    /// Most memory that the mesh of a scene file may take, as 512M or 4G [default: what the machine has]
    #[arg(long, global = true, value_name = "SIZE", value_parser = options::size)]
    max_memory: Option<u64>,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Bench(bench::Arguments),
    Build(build::Arguments),
    Render(render::Arguments),
    Heatmap(heatmap::Arguments),
    Experiment(arguments::Arguments),
    Animate(animate::Arguments),
    Verify(verify::Arguments),
    Advise(advise::Arguments),
    Tune(tune::Arguments),
    Scenes(scenes::Arguments),
    Table(table::Arguments),
    Plot(plot::Arguments),
    #[command(alias = "bars")]
    Targets(targets::Arguments),
    Ablation(ablation::Arguments),
    Compare(compare::Arguments),
    Kernels(kernels::Arguments),
    Leaks(leaks::Arguments),
    Scaling(scaling::Arguments),
    Reduce(reduce::Arguments),
    Merge(merge::Arguments),
    Readme(pages::readme::Arguments),
    Report(pages::report::Arguments),
    Memory(memory::Arguments),
    #[command(hide = true)]
    Turns(turns::Arguments),
}

/// Runs the command that the process was started with.
pub fn main() -> ExitCode {
    run(std::env::args_os())
}

/// Runs the command given by `arguments`, the program's name first.
pub fn run(arguments: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> ExitCode {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        // One line, as for all that verbs refuse.
        Err(error) if error.kind() == ErrorKind::ValueValidation => {
            let text = error.to_string();
            let reason = text.lines().next().unwrap_or_default().trim_start_matches("error: ");
            return failure::Failure::Bad(reason.to_owned()).report();
        }
        Err(error) => {
            // Help and version arrive here too, with code 0. If they cannot be printed, nothing is left to do.
            let _ = error.print();
            return ExitCode::from(error.exit_code() as u8);
        }
    };
    if let Err(reason) = crate::simd::Isa::check_environment() {
        return failure::Failure::Bad(reason).report();
    }
    if let Some(memory) = arguments.max_memory {
        limit(Limits { memory });
    }
    match catch_out_of_memory(|| dispatch(&arguments.verb)) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(failure)) => failure.report(),
        Err(error) => failure::Failure::Wrong(error.to_string()).report(),
    }
}

fn dispatch(verb: &Verb) -> Result<(), failure::Failure> {
    match verb {
        Verb::Bench(arguments) => bench::run(arguments),
        Verb::Build(arguments) => build::run(arguments),
        Verb::Render(arguments) => render::run(arguments),
        Verb::Heatmap(arguments) => heatmap::run(arguments),
        Verb::Experiment(arguments) => experiment::run(arguments),
        Verb::Animate(arguments) => animate::run(arguments),
        Verb::Verify(arguments) => verify::run(arguments),
        Verb::Advise(arguments) => advise::run(arguments),
        Verb::Tune(arguments) => tune::run(arguments),
        Verb::Scenes(arguments) => scenes::run(arguments),
        Verb::Table(arguments) => table::run(arguments),
        Verb::Plot(arguments) => plot::run(arguments),
        Verb::Targets(arguments) => targets::run(arguments),
        Verb::Ablation(arguments) => ablation::run(arguments),
        Verb::Reduce(arguments) => reduce::run(arguments),
        Verb::Merge(arguments) => merge::run(arguments),
        Verb::Compare(arguments) => compare::run(arguments),
        Verb::Kernels(arguments) => kernels::run(arguments),
        Verb::Leaks(arguments) => leaks::run(arguments),
        Verb::Scaling(arguments) => scaling::run(arguments),
        Verb::Readme(arguments) => pages::readme::run(arguments),
        Verb::Report(arguments) => pages::report::run(arguments),
        Verb::Memory(arguments) => memory::run(arguments),
        Verb::Turns(arguments) => turns::run(arguments),
    }
}
