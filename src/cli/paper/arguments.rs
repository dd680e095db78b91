//! The arguments of `phr experiment`.

use crate::cli::failure::Failure;
use crate::cli::options::width;
use crate::cli::place::results_place;
use std::path::{Path, PathBuf};

/// Make one of the paper's experiments: measure, draw, and tell what was found
///
/// Builders built and traced as by `phr bench`: the paper's methods in construction-speed (5.1) and trace-speed
/// (5.2), or such as differ in one thing: spatial-splits (5.3), grid (5.4: alpha and delta), cost-counts (4.2),
/// constant-cut (4.3), presplitting (5.3), bucket-sort (4.7), auxiliary-trees (5.5). Within a build: cut-size
/// (Figure 4), split (Figures 3 and 5; one scene). Without scenes, the built-in generated set is used.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Name of the experiment
    pub name: String,
    /// Scene files or names of generated scenes
    pub scenes: Vec<String>,
    /// Children per node: 4 or 8
    #[arg(long, default_value_t = 4, value_name = "N", value_parser = width)]
    pub width: u32,
    /// Views per scene, at most
    #[arg(long, default_value_t = 3, value_name = "N")]
    pub views: usize,
    /// Pixels across and down
    #[arg(long, default_value_t = 256, value_name = "PIXELS")]
    pub size: u32,
    /// Visits to each builder
    #[arg(long, default_value_t = 5, value_name = "N")]
    pub rounds: usize,
    /// Seconds per scene, at least: rounds are added until they have passed
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub seconds: u64,
    /// Threads for each side [default: all processors]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Seed of the paths and of the order of visits
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub seed: u64,
    /// Folder of the results [default: results/experiments/NAME]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Name of this machine in the records
    #[arg(long, default_value = "anonymous")]
    pub host: String,
    /// Continue a stopped run, or add rounds or scenes to a run
    #[arg(long)]
    pub resume: bool,
    /// Remove the results of an earlier run in the folder
    #[arg(long, conflicts_with = "resume")]
    pub replace: bool,
    /// Measure nothing: take the rows of this results folder, of `phr bench` for instance (repeatable: of several,
    /// such as times of one and steps of another)
    #[arg(long, value_name = "DIR", conflicts_with_all = MEASURED)]
    pub rows: Vec<PathBuf>,
    /// List what would be run
    #[arg(long, conflicts_with_all = ["rows", "redraw", "check"])]
    pub list: bool,
    /// Measure nothing: draw and tell again from the CSV in the folder
    #[arg(long, conflicts_with_all = MEASURED)]
    pub redraw: bool,
    /// Measure and draw nothing; fail if figures or findings in the folder are not those of the CSV
    #[arg(long, conflicts_with_all = MEASURED)]
    pub check: bool,
}

/// What says how to measure.
const MEASURED: [&str; 10] =
    ["scenes", "views", "size", "rounds", "seconds", "threads", "seed", "host", "resume", "replace"];

impl Arguments {
    /// The folder of the results.
    pub fn folder(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| Path::new("results/experiments").join(&self.name))
    }

    /// Refuses options that have no effect where an experiment looks into a build, and results in `csv` that would be
    /// written over.
    ///
    /// # Errors
    /// The first of them.
    pub fn check_for_a_build(&self, csv: &str) -> Result<(), Failure> {
        let given = [
            ("--width", self.width != 4),
            ("--views", self.views != 3),
            ("--size", self.size != 256),
            ("--rounds", self.rounds != 5),
            ("--seconds", self.seconds != 0),
            ("--seed", self.seed != 1),
            ("--host", self.host != "anonymous"),
            ("--resume", self.resume),
            ("--rows", !self.rows.is_empty()),
            ("--list", self.list),
        ];
        if let Some((option, _)) = given.into_iter().find(|(_, is_given)| *is_given) {
            let name = &self.name;
            return Err(Failure::Bad(format!(
                "experiment {name}: {option} has no effect, it counts within a build of each scene; leave it out"
            )));
        }
        if self.only_reads() { Ok(()) } else { results_place(&self.folder().join(csv), self.replace) }
    }

    /// Whether nothing is to be measured.
    pub fn only_reads(&self) -> bool {
        self.redraw || self.check || !self.rows.is_empty()
    }
}
