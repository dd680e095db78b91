//! `phr experiment`: the paper's experiments, and the figures that look into a build.

use super::arguments::Arguments;
use super::{cut_size, split, told};
use crate::bench::chosen::Chosen;
use crate::bench::files::new_folder;
use crate::bench::plan::{Plan, Request, Set};
use crate::bench::recorder::RecordOptions;
use crate::bench::row;
use crate::bench::settings::Settings;
use crate::cli::failure::Failure;
use crate::cli::measuring::{make, verdict};
use crate::cli::options::{all_threads, check_name, command_line};
use crate::cli::output::say;
use crate::cli::progress::Bar;
use crate::experiments::contest::{self, EXPERIMENTS, Experiment};
use std::path::Path;
use std::slice::from_ref;

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.name == cut_size::NAME {
        return cut_size::run(arguments);
    }
    if arguments.name == split::NAME {
        return split::run(arguments);
    }
    let Some(experiment) = contest::by_name(&arguments.name) else {
        let mut known: Vec<&str> = EXPERIMENTS.iter().map(|experiment| experiment.name).collect();
        known.extend([cut_size::NAME, split::NAME]);
        return Err(Failure::Bad(format!(
            "no experiment is called {}; there are {}",
            arguments.name,
            known.join(", ")
        )));
    };
    let folder = arguments.folder();
    if arguments.only_reads() {
        let folders = if arguments.rows.is_empty() { from_ref(&folder) } else { &arguments.rows };
        let mut rows = Vec::new();
        for folder in folders {
            rows.extend(row::read(folder)?);
        }
        if folders.len() > 1 {
            check_alike(&rows)?;
        }
        if !arguments.check {
            new_folder(&folder)?;
        }
        return tell(experiment, arguments, &rows, &folder);
    }
    let mut plan = Plan::new(&request(experiment, arguments)?)?;
    if arguments.list {
        return say(&plan.lines().collect::<Vec<_>>().join("\n"));
    }
    check_name("host", &arguments.host)?;
    plan.check_files()?;
    let records = RecordOptions {
        folder: &folder,
        resume: arguments.resume,
        replace: arguments.replace,
        host: &arguments.host,
        arguments: command_line(),
    };
    // The bytes of builds are no question of any experiment.
    let outcome = make(&plan, records, None, Bar::new(false))?;
    let told = tell(experiment, arguments, &outcome.rows, &folder);
    // What failed, or that the run was stopped, says more than that there is nothing to draw.
    verdict(&outcome.rows, outcome.failures, outcome.complete, &folder)?;
    told
}

/// Refuses rows of one scene that are of other geometry or threads: they cannot stand beside each other.
fn check_alike(rows: &[row::Row]) -> Result<(), Failure> {
    for row in rows {
        let of_scene = rows.iter().find(|first| first.scene == row.scene);
        let is_unlike =
            |first: &&row::Row| (&first.scene_sha, first.threads) != (&row.scene_sha, row.threads);
        if of_scene.filter(is_unlike).is_some() {
            return Err(Failure::Bad(format!(
                "{}: rows of other geometry or threads than others of it; give --rows of runs that are alike",
                row.scene
            )));
        }
    }
    Ok(())
}

fn request(experiment: &Experiment, arguments: &Arguments) -> Result<Request, Failure> {
    let none: [&Path; 0] = [];
    let threads = arguments.threads.unwrap_or_else(all_threads);
    let settings = Settings {
        seconds: arguments.seconds,
        seed: arguments.seed,
        ..Settings::new(arguments.size, arguments.views, arguments.rounds, threads)
    };
    Ok(Request {
        scenes: arguments.scenes.clone(),
        set: arguments.scenes.is_empty().then_some(Set::Builtin),
        folder: None,
        builders: Chosen::new(&(experiment.entrants)(), &[], &none)?,
        width: Some(arguments.width),
        filter: None,
        shard: None,
        settings,
    })
}

/// Draws what the rows say and tells it, or checks what was drawn and told.
fn tell(
    experiment: &Experiment,
    arguments: &Arguments,
    rows: &[row::Row],
    folder: &Path,
) -> Result<(), Failure> {
    let drawings = contest::figures(experiment, rows, arguments.width);
    if drawings.is_empty() {
        let (folder, name, width) = (folder.display(), experiment.name, arguments.width);
        let other = rows.iter().map(|row| row.width).find(|other| *other != width);
        let remedy = match other {
            Some(other) if rows.iter().all(|row| row.width != width) => format!("give --width {other}"),
            _ => format!("run `phr experiment {name}` first"),
        };
        return Err(Failure::Bad(format!("{folder}: no rows of {name} at width {width}; {remedy}")));
    }
    let text = contest::findings(experiment, rows, arguments.width);
    let act = if arguments.check { told::compare } else { told::write };
    act(&text, &drawings, folder)
}
