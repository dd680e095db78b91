//! `phr bench`: times builders and traces, and writes the records.

use super::pages::made_of_rows;
use crate::bench::chosen::Chosen;
use crate::bench::contender::saved::{check, offer};
use crate::bench::merge::SHARDS;
use crate::bench::moment::Moment;
use crate::bench::plan::{Plan, Request, Set};
use crate::bench::recorder::RecordOptions;
use crate::bench::settings::Settings;
use crate::bench::shard::Shard;
use crate::cli::failure::Failure;
use crate::cli::measuring::{make, verdict};
use crate::cli::options::{all_threads, check_name, command_line, percent, seconds, width};
use crate::cli::output::say;
use crate::cli::plan_outline::outline;
use crate::cli::progress::Bar;
use crate::cli::run_summary::run_summary;
use crate::report::table::{self, brief};
use regex::Regex;
use std::path::{Path, PathBuf};

/// Build and trace scenes with every builder, in interleaved rounds, and write rows, table, plots and page to
/// results/NAME/
///
/// Without scenes, the built-in generated set is run.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene files (.ply, .obj, .stl, .gltf, .glb, plain or .gz or .zst) or names of generated scenes (see `phr
    /// scenes`)
    scenes: Vec<String>,
    /// A set of scenes: builtin or paper. Or a builder with this field of its configuration changed (repeatable):
    /// BUILDER.FIELD=VALUE, as phr-hq.delta=8; it is called phr-hq[delta=8] and stands beside those of --builder
    #[arg(long = "set", value_name = "SET|CHANGE")]
    sets: Vec<String>,
    /// Folder with the paper's own scene files, used by --set paper in place of the stand-ins
    #[arg(long = "scenes", value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Only this builder (repeatable)
    #[arg(long = "builder", value_name = "NAME")]
    builders: Vec<String>,
    /// The builder of this file (repeatable): {"name": NAME, "base": BUILDER, "fields": {"FIELD": VALUE}}
    #[arg(long = "config", value_name = "FILE")]
    configs: Vec<PathBuf>,
    /// Load and trace the tree of this file too, which `phr build -o` saved for the one scene (repeatable); its
    /// build time is that of loading it
    #[arg(long = "tree", value_name = "FILE")]
    trees: Vec<PathBuf>,
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
    #[arg(long, default_value_t = 300, value_name = "N", value_parser = seconds, requires = "until")]
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
    #[arg(long, conflicts_with_all = ["size", "views"])]
    build_only: bool,
    /// Time builds on one thread too, beside those on all; with --build-only
    #[arg(long)]
    one_thread: bool,
    /// Time whole path-traced frames too
    #[arg(long, conflicts_with = "build_only")]
    frames: bool,
    /// Only the K-th of N parts of the scenes, into shards/K-of-N below the folder of the results; see `phr merge`
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// Folder of the results [default: results/NAME]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Name of the results [default: the set's or the scenes']
    #[arg(long, conflicts_with = "out")]
    name: Option<String>,
    /// Name of this machine in the records
    #[arg(long, default_value = "anonymous")]
    host: String,
    /// Continue a stopped run, or add rounds, scenes or builders to a run
    #[arg(long)]
    resume: bool,
    /// Remove the results of an earlier run in the folder
    #[arg(long, conflicts_with = "resume")]
    replace: bool,
    /// Print every regime and kernel in the tables, not what matters alone
    #[arg(long)]
    all_columns: bool,
    /// List what would be run, one "scene builder width kernel" per line
    #[arg(long)]
    list: bool,
    /// Check everything and print the plan without running it
    #[arg(long)]
    dry_run: bool,
}

/// The sets of scenes by name.
const SETS: [(&str, Set); 2] = [("builtin", Set::Builtin), ("paper", Set::Paper)];

impl Arguments {
    /// The set of scenes.
    fn set(&self) -> Option<Set> {
        let named = SETS.iter().find(|(name, _)| self.sets.iter().any(|set| set == name));
        named.map(|(_, set)| *set).or(self.scenes.is_empty().then_some(Set::Builtin))
    }

    /// The builders, those with changed fields among them.
    fn builders(&self) -> Result<Chosen, Failure> {
        let is_set = |text: &&String| SETS.iter().any(|(name, _)| text == name);
        if self.sets.iter().filter(is_set).count() > 1 {
            return Err(Failure::Bad("--set names two sets of scenes; give one".into()));
        }
        let changes: Vec<String> = self.sets.iter().filter(|text| !is_set(text)).cloned().collect();
        if let Some(name) = changes.iter().find(|text| !text.contains('=')) {
            return Err(Failure::Bad(format!(
                "--set {name}: give builtin or paper, a set of scenes, or BUILDER.FIELD=VALUE, a changed builder"
            )));
        }
        Ok(Chosen::new(&self.builders, &changes, &self.configs)?)
    }

    fn request(&self) -> Result<Request, Failure> {
        let quick = self.set() == Some(Set::Builtin);
        if let (Some(folder), true) = (&self.folder, self.set() != Some(Set::Paper)) {
            let folder = folder.display();
            return Err(Failure::Bad(format!(
                "--scenes {folder}: has the scenes of --set paper; give that too"
            )));
        }
        let size = self.size.unwrap_or(match self.set() {
            Some(Set::Paper) => 1024,
            Some(Set::Builtin) => 256,
            None => 512,
        });
        let rounds = self.rounds.unwrap_or(if quick { 4 } else { 5 });
        let settings = Settings {
            seconds: self.seconds,
            until_permille: self.until.map_or(0, |until| (1000.0 * until).ceil() as u32),
            limit: self.limit,
            seed: self.seed,
            build_only: self.build_only,
            one_thread: self.one_thread,
            frames: self.frames,
            ..Settings::new(size, self.views, rounds, self.threads.unwrap_or_else(all_threads))
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
            builders: self.builders()?,
            width: self.width,
            filter: self.filter.as_ref().map(regex).transpose()?,
            shard: self.shard,
            settings,
        })
    }

    /// Refuses names that are none in a folder or a table.
    fn check_names(&self) -> Result<(), Failure> {
        for (option, name) in [("name", self.name.as_deref()), ("host", Some(&*self.host))] {
            name.map_or(Ok(()), |name| check_name(option, name))?;
        }
        Ok(())
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
    arguments.check_names()?;
    let saved = offer(&arguments.trees)?;
    let mut request = arguments.request()?;
    request.builders = request.builders.and(saved.clone());
    let mut plan = Plan::new(&request)?;
    let planned = |name: &String| plan.lines().any(|line| line.contains(name.as_str()));
    if let Some(name) = saved.iter().find(|name| !planned(name)) {
        return Err(Failure::Bad(format!(
            "--tree: {name} is not of the --width or --filter given; leave that out"
        )));
    }
    if !arguments.trees.is_empty() && plan.scenes.len() != 1 {
        return Err(Failure::Bad("--tree: a tree is of one scene; give that scene alone".into()));
    }
    if arguments.list {
        return say(&plan.lines().collect::<Vec<_>>().join("\n"));
    }
    let folder = arguments.folder(&plan);
    plan.check_files()?;
    if arguments.dry_run {
        return say(&outline(&plan, &folder));
    }
    if !arguments.trees.is_empty()
        && let Some((scene, _)) = plan.scenes.first()
    {
        check(&scene.load()?.mesh)?;
    }
    if let Some(reason) = arguments.when_quiet.then(|| Moment::now(plan.settings.threads).busy()).flatten() {
        let remedy = "wait for a quiet hour or run without --when-quiet";
        return Err(Failure::Inconclusive(format!("{reason}; {remedy}")));
    }
    let program = std::env::current_exe().ok();
    let records = RecordOptions {
        folder: &folder,
        resume: arguments.resume,
        replace: arguments.replace,
        host: &arguments.host,
        arguments: command_line(),
    };
    let outcome = make(&plan, records, program.as_deref(), Bar::new(arguments.all_columns))?;
    say(&if arguments.all_columns {
        table::closing(&outcome.rows)
    } else {
        brief::means(&outcome.rows) + &brief::legend(&outcome.rows)
    })?;
    let plots = made_of_rows(&outcome.rows, outcome.complete, &folder)?;
    say(&run_summary(&outcome.rows, &folder, &plots))?;
    verdict(&outcome.rows, outcome.failures, outcome.complete, &folder)
}
