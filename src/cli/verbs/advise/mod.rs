//! `phr advise`: which builder for a scene and a number of rays.

pub mod tune;

use crate::bench::cell::Kernel;
use crate::bench::files::{new_folder, write_whole};
use crate::bench::planned_scene::PlannedScene;
use crate::bench::row;
use crate::cli::failure::Failure;
use crate::cli::options::{Made, Widths, all_threads, loaded, pools, rays, seconds, traceable, widths};
use crate::cli::output::say;
use crate::cli::place::{FileKind, check_place};
use crate::cli::progress::Steps;
use crate::cli::verbs::plot::draw;
use crate::report::advice::measured::Measurement;
use crate::report::advice::model::facts::SceneFacts;
use crate::report::advice::model::{Model, choose, judged, judged_files};
use crate::report::advice::rows::{self, ADVICE};
use crate::report::advice::{Advice, page};
use crate::report::plot::total_time::total_time;
use crate::scene::Scene;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Tell which builder to take for a scene and a number of rays: total time = build + rays / speed
///
/// Measures the scene for some seconds, or takes a model with --instant. Prints every builder with its intervals,
/// the best, and which is best from how many rays on; writes advice.csv, advice.svg and advice.png.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene file or name of a generated scene
    #[arg(required_unless_present_any = ["fit", "judge"])]
    scene: Option<String>,
    /// Number of rays: 50M, 1G, 3e8
    #[arg(long, default_value = "100M", value_name = "N", value_parser = rays)]
    rays: f64,
    /// Trees of this width: 4, 8 or both
    #[arg(long, default_value = "both", value_name = "N", value_parser = widths)]
    width: Widths,
    /// Seconds to measure, from the loaded scene on
    #[arg(long, default_value_t = 30, value_name = "N", value_parser = seconds)]
    seconds: u64,
    /// Measure nothing: advise by the model over facts of the mesh
    #[arg(long, conflicts_with_all = MEASURED)]
    instant: bool,
    /// Only this builder (repeatable) [default: all in tables]
    #[arg(long = "builder", value_name = "NAME")]
    builders: Vec<String>,
    #[command(flatten)]
    made: Made,
    /// What traces the trees: embree-grafted or phr [default: embree-grafted where this program has it]
    #[arg(long, value_name = "KERNEL")]
    kernel: Option<String>,
    /// Threads [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Folder for CSV and plot [default: results/advice-SCENE, with --instant results/advice-SCENE-instant]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// The model [default: the one in this program]; with --judge each scene's is fitted to the others
    #[arg(long, value_name = "FILE", conflicts_with = "judge")]
    model: Option<PathBuf>,
    /// Fit the model to the rows of a results folder and write it to the file of --model
    #[arg(long, value_name = "RESULTS", requires = "model", conflicts_with = "judge")]
    #[arg(conflicts_with_all = ADVISED, conflicts_with_all = MEASURED)]
    fit: Option<PathBuf>,
    /// With --fit: without this scene, for which the model is to be judged
    #[arg(long, value_name = "SCENE", requires = "fit")]
    without: Option<String>,
    /// Print how good the model's advice is: for each scene of a results folder by a model of the others
    #[arg(long, value_name = "RESULTS", conflicts_with_all = ADVISED, conflicts_with_all = MEASURED)]
    judge: Option<PathBuf>,
    /// With --judge: how good the advice in the subfolders of this folder is instead, by the run's total times
    #[arg(long, value_name = "DIR", requires = "judge", conflicts_with = "withheld")]
    advice: Option<PathBuf>,
    /// With --judge: also for the scenes of this folder, by a model of all of the first
    #[arg(long, value_name = "RESULTS", requires = "judge")]
    withheld: Option<PathBuf>,
}

/// What says for what advice is wanted.
const ADVISED: [&str; 5] = ["scene", "rays", "width", "instant", "out"];
/// What says how to measure.
const MEASURED: [&str; 6] = ["seconds", "builders", "changes", "configs", "kernel", "threads"];

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let (Some(results), Some(file)) = (&arguments.fit, &arguments.model) {
        check_place(file, FileKind::Json)?;
        let refused = |reason| Failure::Bad(format!("{}: {reason}", results.display()));
        let mut rows = row::read(results)?;
        let all = rows.len();
        rows.retain(|row| Some(&row.scene) != arguments.without.as_ref());
        if let Some(scene) = arguments.without.as_ref().filter(|_| rows.len() == all) {
            return Err(Failure::Bad(format!("--without {scene}: {} has no such scene", results.display())));
        }
        let model = choose::model_of(&rows).map_err(refused)?;
        write_whole(file, model.file().as_bytes())?;
        return say(&format!("{}: {} trees from {} scenes", file.display(), model.trees.len(), model.scenes));
    }
    if let Some(results) = &arguments.judge {
        let told = |page: Result<String, String>| {
            say(&page.map_err(|reason| Failure::Bad(format!("{}: {reason}", results.display())))?)
        };
        if let Some(folder) = &arguments.advice {
            return told(judged_files::page(&row::read(results)?, &rows::read_all(folder)?));
        }
        let withheld = arguments.withheld.as_deref().map(row::read).transpose()?;
        return told(judged::page(&row::read(results)?, withheld.as_deref()));
    }
    let model = arguments.model.as_deref().map_or_else(|| Ok(Model::committed()), Model::read)?;
    let measurement = if arguments.instant { None } else { Some(measurement(arguments)?) };
    let planned = PlannedScene::find(arguments.scene.as_deref().unwrap_or_default())?;
    let scene = if arguments.instant { loaded(&planned)? } else { traceable(&planned)? };
    let advice = match measurement {
        Some(measurement) => {
            let steps = Steps::new(&scene.name);
            measurement.advise(&scene, &model, &mut |doing| steps.at(doing)).map_err(Failure::Wrong)?
        }
        None => instantly(arguments, &scene, &model)?,
    };
    let folder = || {
        let how = if arguments.instant { "-instant" } else { "" };
        Path::new("results").join(format!("advice-{}{how}", scene.name))
    };
    write(&advice, &arguments.out.clone().unwrap_or_else(folder))
}

fn measurement(arguments: &Arguments) -> Result<Measurement, Failure> {
    let threads = arguments.threads.unwrap_or_else(all_threads);
    pools(threads)?;
    if arguments.seconds == 0 {
        return Err(Failure::Bad(
            "--seconds 0: nothing would be measured; give 1 or more, or --instant".into(),
        ));
    }
    let chosen = arguments.made.chosen(&arguments.builders)?;
    let mut cells = chosen.cells(false)?;
    cells.retain(|cell| arguments.width.0.contains(&cell.width));
    if cells.is_empty() {
        return Err(Failure::Bad("--width: none of the builders given has such trees; leave it out".into()));
    }
    let wanted = arguments.kernel.as_deref();
    let has = |kernel: Kernel| cells.iter().any(|cell| cell.kernels.contains(&kernel));
    let default = if has(Kernel::EmbreeGrafted) { Kernel::EmbreeGrafted } else { Kernel::Phr };
    let kernel = wanted.map_or(Some(default), Kernel::by_name).filter(|&kernel| has(kernel));
    let kernel = kernel.ok_or_else(|| {
        let wanted = wanted.unwrap_or_default();
        Failure::Bad(format!(
            "--kernel {wanted}: traces none of these trees here; give embree-grafted or phr"
        ))
    })?;
    cells.retain(|cell| cell.kernels.contains(&kernel));
    let limit = Duration::from_secs(arguments.seconds);
    Ok(Measurement { cells, rays: arguments.rays, kernel, threads, limit })
}

fn instantly(arguments: &Arguments, scene: &Scene, model: &Model) -> Result<Advice, Failure> {
    let pools = pools(all_threads())?;
    let facts = pools.all.install(|| SceneFacts::of(&scene.mesh, &model.needs()));
    Ok(model.advise(&scene.name, &facts, arguments.rays, &arguments.width.0))
}

/// Prints the advice and writes its files.
fn write(advice: &Advice, folder: &Path) -> Result<(), Failure> {
    say(&page::page(advice))?;
    new_folder(folder)?;
    rows::write(folder, advice)?;
    let plots = draw(&total_time(advice).into_iter().collect::<Vec<_>>(), folder)?;
    let plots: String = plots.iter().map(|plot| format!(", {}", plot.display())).collect();
    say(&format!("\n{}{plots}", folder.join(ADVICE).display()))?;
    if advice.lines().is_empty() {
        let first = advice.trees.first().map_or("no tree of these widths", |known| &known.note);
        let remedy = "give more --seconds, or another --builder";
        return Err(Failure::Wrong(format!(
            "{}: no tree was measured, first {first}; {remedy}",
            advice.scene
        )));
    }
    Ok(())
}
