//! `phr tune`: the parameters for a scene and a number of rays.

use crate::bench::chosen::ConfigFile;
use crate::bench::files::{new_folder, write_json};
use crate::bench::planned_scene::PlannedScene;
use crate::bench::tune::search::Search;
use crate::bench::tune::space::Space;
use crate::cli::failure::Failure;
use crate::cli::options::{all_threads, kernel, pools, rays, seconds, traceable, width};
use crate::cli::output::say;
use crate::cli::place::{FileKind, check_place};
use crate::cli::progress::Steps;
use crate::report::advice::rays_in_words;
use crate::report::advice::tuned::{page, verdict};
use crate::report::advice::tuned_rows::{self, TUNE};
use crate::report::table::brief::filled;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Search the parameters of a builder for a scene and a number of rays
///
/// Tries configurations (of phr-quality and phr-best, unless --builder names another), each measured right after the
/// builder as it is, chosen by a Parzen estimator; races the best of them, and measures the winner again with other
/// rays. With -o, writes a file for --config.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene file or name of a generated scene
    #[arg(required_unless_present = "judge")]
    scene: Option<String>,
    /// Number of rays that a tree is for: 50M, 1G, 3e8
    #[arg(long, default_value = "1G", value_name = "N", value_parser = rays)]
    rays: f64,
    /// The builder whose parameters are searched, and which all is relative to: phr-speed, phr-quality or phr-best (all
    /// three are tried), phr-fast or phr-hq (the paper's parameters), hunt-50, hunt-500, aac or ploc
    #[arg(long, default_value = "phr-quality", value_name = "BUILDER")]
    builder: String,
    /// Seconds, from the loaded scene on
    #[arg(long, default_value_t = 120, value_name = "N", value_parser = seconds)]
    seconds: u64,
    /// Only trees of this width, 4 or 8; the anchor has it too [default: both, the anchor 8]
    #[arg(long, value_name = "N", value_parser = width)]
    width: Option<u32>,
    /// What traces the trees: embree-grafted or phr [default: embree-grafted where this program has it]
    #[arg(long, value_name = "KERNEL")]
    kernel: Option<String>,
    /// Threads [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Seed of the search and of the rays
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,
    /// Folder for tune.csv, all that was tried [default: results/tune-SCENE]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Search nothing: tell what the searches gained whose tune.csv lie in subfolders of this folder
    #[arg(long, value_name = "DIR", conflicts_with_all = SEARCHED)]
    judge: Option<PathBuf>,
    /// File for the configuration, which --config of other commands reads
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Name of the configuration in that file [default: tuned-SCENE-RAYS]
    #[arg(long, requires = "output")]
    name: Option<String>,
}

/// What says what to search, how, and where to.
const SEARCHED: [&str; 11] =
    ["scene", "rays", "builder", "seconds", "width", "kernel", "threads", "seed", "out", "output", "name"];

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(folder) = &arguments.judge {
        return say(&tuned_rows::page(folder)?);
    }
    let threads = arguments.threads.unwrap_or_else(all_threads);
    pools(threads)?;
    if arguments.seconds == 0 {
        return Err(Failure::Bad("--seconds 0: nothing would be tried; give 10 or more".into()));
    }
    arguments.output.as_deref().map(|file| check_place(file, FileKind::Json)).transpose()?;
    let planned = PlannedScene::find(arguments.scene.as_deref().unwrap_or_default())?;
    let name = arguments.name.clone().unwrap_or_else(|| {
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
        let scene: String = planned.name.chars().map(plain).take(40).collect();
        format!("tuned-{scene}-{}", rays_in_words(arguments.rays))
    });
    ConfigFile::check_name(&name).map_err(Failure::Bad)?;
    let refused = |reason| Failure::Bad(format!("--builder {}: {reason}", arguments.builder));
    let search = Search {
        space: Space::of(&arguments.builder).map_err(refused)?,
        rays: arguments.rays,
        width: arguments.width,
        kernel: kernel(arguments.kernel.as_deref())?,
        threads,
        limit: Duration::from_secs(arguments.seconds),
        seed: arguments.seed,
    };
    let scene = traceable(&planned)?;
    let named = || Path::new("results").join(format!("tune-{}", scene.name));
    let folder = arguments.out.clone().unwrap_or_else(named);
    new_folder(&folder)?;
    let steps = Steps::new(&scene.name);
    let tuned = search.run(&scene, &mut |doing| steps.at(doing)).map_err(Failure::Wrong)?;
    drop(steps);
    say(&page(&tuned, &scene.name, arguments.rays))?;
    tuned_rows::write(&folder, &tuned, (&scene.name, scene.mesh.len()), arguments.rays)?;
    say(&folder.join(TUNE).display().to_string())?;
    if let Some(file) = &arguments.output {
        let cell = &tuned.fresh.cell;
        let about = format!(
            "the best of {} configurations for {} rays in {}, by phr tune; it {}",
            tuned.trials.len(),
            rays_in_words(arguments.rays),
            scene.name,
            verdict(&tuned, arguments.rays)
        );
        write_json(file, &ConfigFile::new(&name, &tuned.fresh.recipe, cell.width, about.clone()))?;
        say(filled(&format!("{}: {name}, for --config; {about}", file.display())).trim_end())?;
    }
    Ok(())
}
