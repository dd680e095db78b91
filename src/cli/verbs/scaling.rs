//! `phr scaling`: builds on more threads than the machine has, from the times of their tasks.

use crate::bench::planned_scene::PlannedScene;
use crate::bench::scaling::row::{self, SCALING};
use crate::bench::scaling::{ScalingSettings, measure};
use crate::builders;
use crate::cli::failure::Failure;
use crate::cli::options::{self, Made, distinct};
use crate::cli::output::say;
use crate::cli::place::results_place;
use crate::report::scaling::{means, scene_table};
use std::path::PathBuf;

/// Time the tasks of builds on one thread and schedule them on more workers, into DIR/scaling.csv
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene files or names of generated scenes
    #[arg(required = true)]
    scenes: Vec<String>,
    /// Builder of ours (repeatable) [default: those of the tables]
    #[arg(long = "builder", value_name = "NAME")]
    builders: Vec<String>,
    #[command(flatten)]
    made: Made,
    /// Children per node (repeatable) [default: 4 and 8]
    #[arg(long = "width", value_name = "N", value_parser = options::width)]
    widths: Vec<u32>,
    /// Workers (repeatable); as many threads are measured beside them where the machine has them
    #[arg(long, value_name = "N", default_values_t = [1, 2, 4, 8, 16, 32, 64])]
    workers: Vec<usize>,
    /// Builds for each number of workers
    #[arg(long, default_value_t = 3, value_name = "N")]
    rounds: usize,
    /// Folder of the results
    #[arg(long, default_value = "results/scaling", value_name = "DIR")]
    out: PathBuf,
    /// Replace the results of an earlier run in the folder
    #[arg(long)]
    replace: bool,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = settings(arguments)?;
    let scenes = PlannedScene::find_all(&arguments.scenes)?;
    results_place(&arguments.out.join(SCALING), arguments.replace)?;
    let mut rows = Vec::new();
    for planned in scenes {
        let scene = options::loaded(&planned)?;
        let of_scene = measure(&scene, &settings);
        rows.extend(of_scene.map_err(|why| Failure::Bad(format!("{}: {why}", scene.name)))?);
        say(&(scene_table(&rows, &scene.name) + "\n"))?;
        row::write(&arguments.out.join(SCALING), &rows)?;
    }
    say(&means(&rows))
}

fn settings(arguments: &Arguments) -> Result<ScalingSettings, Failure> {
    if arguments.rounds == 0 || arguments.workers.contains(&0) {
        return Err(Failure::Bad("--rounds, --workers: nothing could run; give 1 or more".into()));
    }
    let names = || builders::NAMES.iter().map(|&name| name.to_owned()).collect();
    let is_default = arguments.builders.is_empty() && arguments.made.is_empty();
    let names: Vec<String> = if is_default { names() } else { arguments.builders.clone() };
    let widths = if arguments.widths.is_empty() { vec![4, 8] } else { arguments.widths.clone() };
    Ok(ScalingSettings {
        cells: options::cells(&names, &arguments.made, &widths)?,
        workers: distinct(&arguments.workers),
        rounds: arguments.rounds,
        most: options::all_threads(),
    })
}
