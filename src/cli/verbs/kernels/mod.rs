//! `phr kernels`: single rays, packets, streams and batches over the same trees, side by side, and single rays over
//! trees of other builders; and how many rays leak.

pub mod leaks;

use crate::bench::kernels::row::{self, KERNELS, KernelRow};
use crate::bench::kernels::{KernelSettings, left_out, measure};
use crate::bench::planned_scene::PlannedScene;
use crate::bench::settings::Settings;
use crate::cli::failure::Failure;
use crate::cli::options::{self, Made, distinct};
use crate::cli::output::say;
use crate::cli::place::results_place;
use crate::report::kernels::{scene_table, summary};
use crate::trace::PathSettings;
use std::path::PathBuf;
use std::time::Duration;

/// Builders of the trees unless others are named.
const BUILDERS: [&str; 5] = ["embree-sah", "embree-fast-spatial", "phr-speed", "phr-quality", "phr-best"];

/// Trace the same rays by all kernels of Embree's and ours, over the same trees and by turns, into DIR/kernels.csv
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene files or names of generated scenes
    #[arg(required = true)]
    scenes: Vec<String>,
    /// Builder (repeatable); all kernels trace the trees of the first, Embree's, single rays those of the others
    /// [default: embree-sah, embree-fast-spatial, phr-speed, phr-quality, phr-best]
    #[arg(long = "builder", value_name = "NAME")]
    builders: Vec<String>,
    #[command(flatten)]
    made: Made,
    /// Children per node (repeatable) [default: 4 and 8]
    #[arg(long = "width", value_name = "N", value_parser = options::width)]
    widths: Vec<u32>,
    /// Threads (repeatable) [default: 1]
    #[arg(long, value_name = "N")]
    threads: Vec<usize>,
    /// Pixels across and down
    #[arg(long, default_value_t = 256, value_name = "PIXELS")]
    size: u32,
    /// Views per scene, at most
    #[arg(long, default_value_t = 1, value_name = "N")]
    views: usize,
    /// Passes of each kernel over the rays, at least
    #[arg(long, default_value_t = 7, value_name = "N")]
    rounds: usize,
    /// A kind of rays gets more passes until it was measured for N seconds, on each number of threads
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = options::seconds)]
    seconds: u64,
    /// Leave out scenes with fewer triangles
    #[arg(long, default_value_t = 0, value_name = "N")]
    least: usize,
    /// Folder of the results
    #[arg(long, default_value = "results/kernels", value_name = "DIR")]
    out: PathBuf,
    /// Replace the results of an earlier run in the folder
    #[arg(long)]
    replace: bool,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = settings(arguments)?;
    let scenes = PlannedScene::find_all(&arguments.scenes)?;
    results_place(&arguments.out.join(KERNELS), arguments.replace)?;
    let mut rows = Vec::new();
    for planned in scenes {
        let scene = options::traceable(&planned)?;
        if scene.mesh.len() < arguments.least {
            say(&format!("{}: {} triangles, left out\n", scene.name, scene.mesh.len()))?;
            continue;
        }
        rows.extend(
            measure(&scene, &settings).map_err(|why| Failure::Bad(format!("{}: {why}", scene.name)))?,
        );
        say(&scene_table(&rows, &scene.name))?;
        row::write(&arguments.out.join(KERNELS), &rows)?;
    }
    say(&summary(&rows))?;
    if let Some(kernels) = left_out() {
        say(&format!("Left out: {kernels}.\n"))?;
    }
    say(&others_wrong(&rows))?;
    match rows.iter().filter(|row| row.is_ours() && !row.verified).count() {
        0 => Ok(()),
        wrong => Err(Failure::Wrong(format!("{wrong} rows of wrong hits, see `verified` in {KERNELS}"))),
    }
}

/// The rows of wrong hits by kernels of others, a line each: they are told, not mended.
fn others_wrong(rows: &[KernelRow]) -> String {
    let told = |row: &KernelRow| {
        let KernelRow { scene, kernel, width, threads, ray_kind, .. } = row;
        format!("Wrong hits: {scene}, {kernel} / {width}, {ray_kind} rays, threads: {threads}.\n")
    };
    rows.iter().filter(|row| !row.is_ours() && !row.verified).map(told).collect()
}

fn settings(arguments: &Arguments) -> Result<KernelSettings, Failure> {
    let or =
        |given: &[u32], default: &[u32]| if given.is_empty() { default.to_vec() } else { given.to_vec() };
    let widths = or(&arguments.widths, &[4, 8]);
    let is_default = arguments.builders.is_empty() && arguments.made.is_empty();
    let builders = if is_default { BUILDERS.map(String::from).into() } else { arguments.builders.clone() };
    let cells = options::cells(&builders, &arguments.made, &widths)?;
    let path = PathSettings { width: arguments.size, height: arguments.size, ..PathSettings::default() };
    let threads = if arguments.threads.is_empty() { vec![1] } else { distinct(&arguments.threads) };
    for &threads in &threads {
        Settings::new(arguments.size, arguments.views, arguments.rounds, threads).check()?;
    }
    let time = Duration::from_secs(arguments.seconds);
    Ok(KernelSettings { cells, path, views: arguments.views, rounds: arguments.rounds, time, threads })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::kernels::row::ROBUST;

    #[test]
    fn wrong_hits_of_others_are_told() {
        let row =
            |kernel: &str, verified| KernelRow { kernel: kernel.into(), verified, ..KernelRow::default() };
        let rows = [row(ROBUST, false), row(ROBUST, true), row("phr-batch", false)];
        let told = others_wrong(&rows);
        assert_eq!(told.lines().count(), 1, "{told}");
        assert!(told.contains(ROBUST), "{told}");
    }
}
