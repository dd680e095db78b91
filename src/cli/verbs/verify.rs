//! `phr verify`: are the hits of all trees those of the reference?

use crate::bench::contender::{self, REFERENCE_KERNEL, TreeUnderKernel};
use crate::bench::plan::{Plan, Request};
use crate::bench::rays;
use crate::bench::samples::KernelChecks;
use crate::bench::settings::Settings;
use crate::bench::visit::{Bench, SceneTraces};
use crate::cli::failure::Failure;
use crate::cli::options::{Made, all_threads, pools, traceable};
use crate::cli::output::say;
use crate::report::grid::Grid;
use std::sync::atomic::AtomicBool;

/// Compare every builder's hits with the reference's (Embree's, where it is there)
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene files or names of generated scenes
    #[arg(required = true)]
    scenes: Vec<String>,
    /// Only this builder (repeatable)
    #[arg(long = "builder", value_name = "NAME")]
    builders: Vec<String>,
    #[command(flatten)]
    made: Made,
    /// Views per scene, at most
    #[arg(long, default_value_t = 3, value_name = "N")]
    views: usize,
    /// Pixels across and down
    #[arg(long, default_value_t = 256, value_name = "PIXELS")]
    size: u32,
    /// Threads [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let threads = arguments.threads.unwrap_or_else(all_threads);
    let settings = Settings::new(arguments.size, arguments.views, 1, threads);
    let request = Request {
        scenes: arguments.scenes.clone(),
        set: None,
        folder: None,
        builders: arguments.made.chosen(&arguments.builders)?,
        width: None,
        shard: None,
        filter: None,
        settings,
    };
    let plan = Plan::new(&request)?;
    let pools = pools(plan.settings.threads)?;
    let (mut wrong, mut failed) = (0, 0);
    for (planned, cells) in &plan.scenes {
        let scene = traceable(planned)?;
        let mut grid =
            Grid::new([&scene.name, "kernel", "rays", "equal", "ties", "edges", "near", "verdict"]);
        let stop = AtomicBool::new(false);
        let built = contender::reference(&scene.mesh, &pools.all).map_err(Failure::Wrong)?;
        let tree = TreeUnderKernel::new(&built, REFERENCE_KERNEL, plan.settings.threads);
        let tree = tree.map_err(Failure::Wrong)?;
        let reference = tree.tracer().map_err(|reason| Failure::Wrong(reason.to_owned()))?;
        let rays = pools.all.install(|| rays::record(reference, &scene, &plan.settings));
        let mut bench =
            Bench::new(SceneTraces::new(&scene, &rays, Some(reference), &plan.settings, &pools, &stop));
        for cell in cells {
            let name = format!("{} / {}", cell.builder, cell.width);
            match bench.verify(cell) {
                Ok(kernels) => {
                    wrong += usize::from(kernels.iter().any(|kernel| kernel.mismatch.is_some()));
                    kernels.iter().for_each(|kernel| grid.push(line(&name, kernel)));
                }
                Err(reason) => {
                    failed += 1;
                    let nothing = std::iter::repeat_n("-".to_owned(), 6);
                    grid.push([name].into_iter().chain(nothing).chain([reason]).collect());
                }
            }
        }
        say(&(grid.markdown() + "\n"))?;
    }
    match (wrong, failed) {
        (0, 0) => Ok(()),
        _ => Err(Failure::Wrong(format!(
            "trees with wrong hits: {wrong}, builders that failed: {failed}; see above"
        ))),
    }
}

fn line(name: &str, kernel: &KernelChecks) -> Vec<String> {
    let sum = |value: fn(&crate::bench::samples::Check) -> u64| {
        kernel.checks.iter().map(value).sum::<u64>().to_string()
    };
    let verdict = match (&kernel.unavailable, &kernel.mismatch) {
        (Some(reason), _) => format!("not available, because {reason}"),
        (_, Some(mismatch)) => format!("WRONG: {mismatch}"),
        _ => "verified".into(),
    };
    vec![
        name.into(),
        kernel.kernel.name().into(),
        sum(|check| check.rays),
        sum(|check| check.equal),
        sum(|check| check.ties),
        sum(|check| check.edge),
        sum(|check| check.near_misses),
        verdict,
    ]
}
