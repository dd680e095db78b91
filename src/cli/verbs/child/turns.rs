//! `phr turns`: builds when told to, for `phr compare --against`.

use crate::bench::planned_scene::PlannedScene;
use crate::bench::turns::child::answer;
use crate::cli::failure::Failure;
use crate::cli::options::{all_threads, pools};

/// Build when told to: load a scene, then answer each line "BUILDER WIDTH" of standard input by the build's
/// milliseconds
///
/// What `phr compare --against` starts.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene file or name of a generated scene
    scene: String,
    /// Threads [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let scene = PlannedScene::find(&arguments.scene)?.load()?;
    let pools = pools(arguments.threads.unwrap_or_else(all_threads))?;
    answer(&scene, &pools, std::io::stdin().lock(), std::io::stdout().lock())?;
    Ok(())
}
