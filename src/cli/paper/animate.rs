//! `phr animate`: trees that follow a moving scene.

use super::told;
use crate::bench::settings::Settings;
use crate::cli::failure::Failure;
use crate::cli::options::{Made, all_threads, cells, distinct, kernel, pools, width};
use crate::cli::place::results_place;
use crate::experiments::animation::{
    self, ANIMATION, AnimationSettings, FrameRow, entrants, measure, records,
};
use crate::geometry::Mesh;
use crate::report::plot::Drawing;
use crate::scene::{Animated, animated, animated_by_name};
use indicatif::ProgressBar;
use std::io::IsTerminal;
use std::path::PathBuf;

/// Let trees follow generated scenes that move: built again, refitted, or refined again, beside Embree's
///
/// In each frame every contestant brings its tree up to date and traces the frame's rays, every answer verified:
/// each builder as `rebuild` and `refit` (of its wide tree), PHR also as `refine` (its auxiliary tree refitted, its
/// cuts refined again) and, where a part of the scene is static, as `merge` and `merge-sah` (that part's auxiliary
/// tree kept); Embree's Morton and SAH builders as `rebuild`, its SAH tree as `refit`. Scenes: wrung, burst, parade
/// [default: all].
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Names of moving scenes
    scenes: Vec<String>,
    /// Builder of ours (repeatable) [default: lbvh, phr-draft, phr-turbo, phr-fast, phr-speed]
    #[arg(long = "builder", value_name = "NAME")]
    builders: Vec<String>,
    #[command(flatten)]
    made: Made,
    /// Frames of each scene
    #[arg(long, default_value_t = 100, value_name = "N")]
    frames: u32,
    /// Triangles of each scene [default: 200,000 or more]
    #[arg(long, value_name = "N")]
    triangles: Option<usize>,
    /// Children per node: 4 or 8
    #[arg(long, default_value_t = 4, value_name = "N", value_parser = width)]
    width: u32,
    /// What traces all trees: embree-grafted or phr [default: embree-grafted where this program has it]
    #[arg(long, value_name = "KERNEL")]
    kernel: Option<String>,
    /// Views, at most
    #[arg(long, default_value_t = 1, value_name = "N")]
    views: usize,
    /// Pixels across and down
    #[arg(long, default_value_t = 160, value_name = "PIXELS")]
    size: u32,
    /// Updates and traces of each contestant in each frame
    #[arg(long, default_value_t = 3, value_name = "N")]
    rounds: usize,
    /// Threads for each side [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Seed of the paths
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,
    /// Folder of the results
    #[arg(long, default_value = "results/animation", value_name = "DIR")]
    out: PathBuf,
    /// Replace the results of an earlier run in the folder
    #[arg(long, conflicts_with_all = ["redraw", "check"])]
    replace: bool,
    /// Measure nothing: draw and tell again from the CSV in the folder
    #[arg(long, conflicts_with_all = MEASURED)]
    redraw: bool,
    /// Measure and draw nothing; fail if figure or findings in the folder are not those of the CSV
    #[arg(long, conflicts_with_all = MEASURED)]
    check: bool,
}

/// What says how to measure.
const MEASURED: [&str; 13] = [
    "scenes",
    "builders",
    "changes",
    "configs",
    "frames",
    "triangles",
    "width",
    "kernel",
    "views",
    "size",
    "rounds",
    "threads",
    "seed",
];

/// Builders of ours unless others are named.
const BUILDERS: [&str; 5] = ["lbvh", "phr-draft", "phr-turbo", "phr-fast", "phr-speed"];
/// Most frames.
const MOST_FRAMES: u32 = 1 << 14;

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let rows = match arguments.redraw || arguments.check {
        true => records::read(&arguments.out)?,
        false => measured(arguments)?,
    };
    let drawings: Vec<Drawing> =
        animation::draw(&rows).map(|svg| Drawing { name: "animation", svg }).into_iter().collect();
    let act = if arguments.check { told::compare } else { told::write };
    act(&animation::findings(&rows), &drawings, &arguments.out)?;
    match rows.iter().filter(|row| !row.verified).count() {
        0 => Ok(()),
        failed => Err(Failure::Wrong(format!(
            "{failed} contestants failed or have wrong hits, see `error` in {ANIMATION}"
        ))),
    }
}

/// Measures all scenes; the rows so far are written after each.
fn measured(arguments: &Arguments) -> Result<Vec<FrameRow>, Failure> {
    let scenes = scenes(arguments)?;
    let trace = trace(arguments)?;
    let kernel = kernel(arguments.kernel.as_deref())?;
    let pools = pools(trace.threads)?;
    let is_default = arguments.builders.is_empty() && arguments.made.is_empty();
    let builders = if is_default { BUILDERS.map(String::from).into() } else { arguments.builders.clone() };
    let cells = cells(&builders, &arguments.made, &[arguments.width])?;
    // Refused before anything is measured or written.
    entrants(&cells, true).map_err(Failure::Bad)?;
    results_place(&arguments.out.join(ANIMATION), arguments.replace)?;
    let mut rows = Vec::new();
    for animated in scenes {
        let triangles = arguments.triangles.unwrap_or(animated.triangles);
        let animation = pools.all.install(|| animated.generate(triangles));
        let settings = AnimationSettings {
            entrants: entrants(&cells, animation.has_static_part()).map_err(Failure::Bad)?,
            frames: arguments.frames,
            rounds: arguments.rounds,
            width: arguments.width,
            kernel,
            trace: trace.clone(),
        };
        let bar = match std::io::stderr().is_terminal() {
            true => ProgressBar::new(arguments.frames.into()),
            false => ProgressBar::hidden(),
        };
        let progress = &mut |frame: u32| bar.set_position(frame.into());
        rows.extend(measure(&animation, &settings, &pools, progress).map_err(Failure::Wrong)?);
        bar.finish_and_clear();
        records::write(&arguments.out.join(ANIMATION), &rows)?;
    }
    Ok(rows)
}

fn scenes(arguments: &Arguments) -> Result<Vec<&'static Animated>, Failure> {
    let known = || animated().iter().map(|scene| scene.name).collect::<Vec<_>>().join(", ");
    let find = |name: &String| {
        animated_by_name(name)
            .ok_or_else(|| Failure::Bad(format!("no moving scene is called {name}; there are {}", known())))
    };
    let (least, most) = (Animated::LEAST, Mesh::MAX_TRIANGLES);
    if let Some(triangles) = arguments.triangles.filter(|count| !(least..=most).contains(count)) {
        return Err(Failure::Bad(format!("--triangles {triangles}: give {least} to {most}")));
    }
    if arguments.scenes.is_empty() {
        return Ok(animated().iter().collect());
    }
    distinct(&arguments.scenes).iter().map(find).collect()
}

fn trace(arguments: &Arguments) -> Result<Settings, Failure> {
    if !(1..=MOST_FRAMES).contains(&arguments.frames) {
        return Err(Failure::Bad(format!("--frames {}: give 1 to {MOST_FRAMES}", arguments.frames)));
    }
    let threads = arguments.threads.unwrap_or_else(all_threads);
    let new = Settings::new(arguments.size, arguments.views, arguments.rounds, threads);
    let settings = Settings { seed: arguments.seed, ..new };
    settings.check()?;
    Ok(settings)
}
