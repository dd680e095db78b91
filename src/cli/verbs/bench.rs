//! `phr bench`: times builders and traces, and writes the records.

use super::plot::draw;
use crate::bench::files::write_whole;
use crate::bench::merge::SHARDS;
use crate::bench::moment::Moment;
use crate::bench::phases;
use crate::bench::plan::{Plan, Request, Set};
use crate::bench::recorder::RecordOptions;
use crate::bench::settings::Settings;
use crate::bench::shard::Shard;
use crate::cli::failure::Failure;
use crate::cli::measuring::{command_line, make, verdict};
use crate::cli::options::{all_threads, percent};
use crate::cli::output::say;
use crate::cli::run_summary::{TABLE, run_summary};
use crate::report::figures::Under;
use crate::report::plot;
use crate::report::table;
use regex::Regex;
use std::path::{Path, PathBuf};

/// Build and trace scenes with every builder, in interleaved rounds, and write rows, table and plot to results/NAME/
///
/// Without scenes, the built-in generated set is run.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene files (.obj, .ply, plain or .gz or .zst) or names of generated scenes (see `phr scenes`)
    scenes: Vec<String>,
    /// A set of scenes: builtin or paper
    #[arg(long, value_name = "SET", value_parser = set)]
    set: Option<Set>,
    /// Folder with the paper's own scene files, used by --set paper in place of the stand-ins
    #[arg(long = "scenes", value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Only this builder (repeatable)
    #[arg(long = "builder", value_name = "NAME")]
    builders: Vec<String>,
    /// Only trees of this width: 4 or 8 children per node
    #[arg(long, value_name = "N", value_parser = width)]
    width: Option<u32>,
    /// Only what matches "scene builder width kernel" (see --list)
    #[arg(long, value_name = "REGEX")]
    filter: Option<String>,
    /// Views per scene, at most
    #[arg(long, default_value_t = 3, value_name = "N")]
    views: usize,
    /// Pixels across and down [default: 1024 for the paper's set, as in the paper; 512 for scenes by name; 256 for the
    /// built-in set]
    #[arg(long, value_name = "PIXELS")]
    size: Option<u32>,
    /// Visits to each builder [default: 5; 4 for the built-in set]
    #[arg(long, value_name = "N")]
    rounds: Option<usize>,
    /// Seconds per scene, at least: rounds are added until they have passed
    #[arg(long, default_value_t = 0, value_name = "N")]
    seconds: u64,
    /// Add rounds until the 95 % intervals of means over scenes, over rounds alone, are within this, as 2%
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    until: Option<f64>,
    /// Seconds per scene after which --until adds no more rounds
    #[arg(long, default_value_t = 300, value_name = "N")]
    limit: u64,
    /// Refuse to start on a busy machine
    #[arg(long)]
    when_quiet: bool,
    /// Threads for each side [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Seed of the paths and of the order of visits
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,
    /// Time builds only
    #[arg(long)]
    build_only: bool,
    /// Time builds on one thread too, beside those on all; with --build-only
    #[arg(long)]
    one_thread: bool,
    /// Time whole path-traced frames too
    #[arg(long)]
    frames: bool,
    /// Only the K-th of N parts of the scenes, into shards/K-of-N below the folder of the results; see `phr merge`
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// Folder of the results [default: results/NAME]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Name of the results [default: the set's or the scenes']
    #[arg(long)]
    name: Option<String>,
    /// Name of this machine in the records
    #[arg(long, default_value = "anonymous")]
    host: String,
    /// Continue a stopped run, or add rounds, scenes or builders to a run
    #[arg(long)]
    resume: bool,
    /// List what would be run, one "scene builder width kernel" per line
    #[arg(long)]
    list: bool,
    /// Check everything and print the plan without running it
    #[arg(long)]
    dry_run: bool,
}

fn set(name: &str) -> Result<Set, String> {
    match name {
        "builtin" => Ok(Set::Builtin),
        "paper" => Ok(Set::Paper),
        _ => Err("there are builtin and paper".into()),
    }
}

fn width(text: &str) -> Result<u32, String> {
    text.parse().ok().filter(|width| [4, 8].contains(width)).ok_or_else(|| "give 4 or 8".into())
}

impl Arguments {
    fn set(&self) -> Option<Set> {
        self.set.or(self.scenes.is_empty().then_some(Set::Builtin))
    }

    fn request(&self) -> Result<Request, Failure> {
        let quick = self.set() == Some(Set::Builtin);
        let size = self.size.unwrap_or(match self.set() {
            Some(Set::Paper) => 1024,
            Some(Set::Builtin) => 256,
            None => 512,
        });
        let settings = Settings {
            width: size,
            height: size,
            views: self.views,
            max_depth: 8,
            rounds: self.rounds.unwrap_or(if quick { 4 } else { 5 }),
            seconds: self.seconds,
            until_permille: self.until.map_or(0, |until| (1000.0 * until).ceil() as u32),
            limit: self.limit,
            threads: self.threads.unwrap_or_else(all_threads),
            seed: self.seed,
            build_only: self.build_only,
            one_thread: self.one_thread,
            frames: self.frames,
        };
        let regex = |text: &String| {
            Regex::new(text).map_err(|error| {
                let reason = error.to_string();
                let reason = reason.lines().last().unwrap_or_default().trim_start_matches("error: ");
                Failure::Bad(format!("--filter {text}: {reason}; give a regular expression"))
            })
        };
        Ok(Request {
            scenes: self.scenes.clone(),
            set: self.set(),
            folder: self.folder.clone(),
            builders: self.builders.clone(),
            variants: Vec::new(),
            width: self.width,
            filter: self.filter.as_ref().map(regex).transpose()?,
            shard: self.shard,
            settings,
        })
    }

    fn folder(&self, plan: &Plan) -> PathBuf {
        let name = || match self.set() {
            Some(Set::Builtin) if self.scenes.is_empty() => "builtin".to_owned(),
            Some(Set::Paper) if self.scenes.is_empty() => "paper-scenes".to_owned(),
            _ => match &plan.all_scenes[..] {
                [scene] => scene.clone(),
                _ => "scenes".to_owned(),
            },
        };
        let folder = self
            .out
            .clone()
            .unwrap_or_else(|| Path::new("results").join(self.name.clone().unwrap_or_else(name)));
        match self.shard {
            Some(shard) => folder.join(SHARDS).join(shard.to_string()),
            None => folder,
        }
    }
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let plan = Plan::new(&arguments.request()?)?;
    if arguments.list {
        return say(&plan.lines().collect::<Vec<_>>().join("\n"));
    }
    let folder = arguments.folder(&plan);
    if arguments.dry_run {
        plan.check_files()?;
        return say(&outline(&plan, &folder));
    }
    plan.check_files()?;
    if let Some(reason) = arguments.when_quiet.then(|| Moment::now(plan.settings.threads).busy()).flatten() {
        let remedy = "wait for a quiet hour or run without --when-quiet";
        return Err(Failure::Inconclusive(format!("{reason}; {remedy}")));
    }
    let program = std::env::current_exe().ok();
    let records = RecordOptions {
        folder: &folder,
        resume: arguments.resume,
        host: &arguments.host,
        arguments: command_line(),
    };
    let outcome = make(&plan, records, program.as_deref())?;
    let document = table::document(&outcome.rows, outcome.complete);
    write_whole(&folder.join(TABLE), document.as_bytes())?;
    say(&table::closing(&outcome.rows))?;
    let plots =
        draw(&plot::figures(&outcome.rows, &phases::read(&folder)?, &Under::best(&outcome.rows)), &folder)?;
    say(&run_summary(&outcome.rows, &folder, &plots))?;
    verdict(&outcome.rows, outcome.failures, outcome.complete, &folder)
}

/// The plan in words.
fn outline(plan: &Plan, folder: &Path) -> String {
    let settings = &plan.settings;
    let mut text = String::new();
    let mut visits = 0;
    for (scene, cells) in &plan.scenes {
        visits += cells.len() * settings.rounds;
        text += &format!(
            "{}: {}, about {} triangles, {} trees\n",
            scene.name,
            scene.origin(),
            scene.triangles,
            cells.len()
        );
    }
    let rays = if settings.build_only {
        "builds only".to_owned()
    } else {
        format!("{} views of {} x {} pixels", settings.views, settings.width, settings.height)
    };
    let (rounds, threads) = (settings.rounds, settings.threads);
    let more = match settings.seconds {
        0 => String::new(),
        seconds => format!(", more where a scene takes less than {seconds} seconds"),
    };
    text + &format!(
        "{visits} visits in {rounds} rounds{more}, {threads} threads, {rays}, into {}",
        folder.display()
    )
}
