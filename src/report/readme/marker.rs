//! A marker in a page, and what it stands for: kinds, words, options, and the text made from the rows.

#![allow(clippy::indexing_slicing, reason = "`Marker::of` counts the words that each kind has")]

use super::error::ReadmeError;
use super::findings::findings;
use crate::bench::environment::{Environment, State};
use crate::bench::files::RecordsError;
use crate::bench::results_dir;
use crate::bench::row::{self, Row};
use crate::bench::{kernels, scaling, turns};
use crate::report::ablation::Ablation;
use crate::report::advice::{self, model::judged, model::judged_files, tuned_rows};
use crate::report::compare::by_turns;
use crate::report::evidence::assertions::assertions;
use crate::report::evidence::constants::constants;
use crate::report::evidence::fronts::fronts;
use crate::report::evidence::holdout::holdout;
use crate::report::evidence::speedups;
use crate::report::figures::{Figure, Under, scenes, tree_named};
use crate::report::kernels::{leaks_table, page, summary as kernel_targets};
use crate::report::means::{Ratios, means};
use crate::report::summary::{spread, summary};
use crate::report::table::details;
use crate::report::table::table1::table1;
use crate::report::table::{document_under, heading, remarks};
use crate::report::{self, targets};
use std::path::Path;

/// The kinds of markers, each with the words that follow; `...` stands for more of the last.
pub(super) const KINDS: [(&str, &str); 26] = [
    ("table", "RESULTS"),
    ("table1", "RESULTS"),
    ("means", "RESULTS"),
    ("scenes", "RESULTS"),
    ("run", "RESULTS"),
    ("value", "RESULTS MEAN FIGURE BUILDER"),
    ("summary", "RESULTS BUILDER..."),
    ("spread", "RESULTS"),
    ("holdout", "RESULTS WITHHELD"),
    ("fronts", "RESULTS WITHHELD"),
    ("constants", "CONSTANTS"),
    ("assertions", "RESULTS WITH WITHOUT"),
    ("targets", "RESULTS..."),
    ("bars", "RESULTS..."),
    ("growth", "RESULTS"),
    ("ablation", "RESULTS BASE BUILDER..."),
    ("kernels", "RESULTS"),
    ("kernel-targets", "RESULTS"),
    ("leaks", "RESULTS"),
    ("scaling", "RESULTS"),
    ("speedups", "RESULTS"),
    ("turns", "RESULTS"),
    ("findings", "EXPERIMENT"),
    ("advice", "RESULTS..."),
    ("measured-advice", "RESULTS"),
    ("tuned", "SEARCHES"),
];
/// Kinds with fixed kernels, which take no `--kernel`.
const OF_FIXED_KERNELS: [&str; 17] = [
    "targets",
    "bars",
    "growth",
    "ablation",
    "fronts",
    "constants",
    "assertions",
    "kernels",
    "kernel-targets",
    "leaks",
    "scaling",
    "speedups",
    "turns",
    "findings",
    "advice",
    "measured-advice",
    "tuned",
];
/// The kind that takes `--withheld RESULTS`.
const OF_WITHHELD: &str = "summary";

/// A marker, taken apart.
pub(super) struct Marker<'a> {
    pub kind: &'a str,
    words: Vec<&'a str>,
    kernel: Option<&'a str>,
    withheld: Option<&'a str>,
    line: usize,
}

impl<'a> Marker<'a> {
    pub fn starts(line: &str) -> bool {
        Marker::of(line.trim(), 0).is_ok_and(|marker| marker.is_some())
    }

    /// `<!-- KIND: WORDS [--kernel KERNEL] [--withheld RESULTS] -->`; other comments are none.
    pub fn of(comment: &'a str, line: usize) -> Result<Option<Self>, ReadmeError> {
        let inside = comment.strip_prefix("<!--").and_then(|rest| rest.strip_suffix("-->"));
        let Some((kind, words)) = inside.and_then(|inside| inside.split_once(':')) else { return Ok(None) };
        let kind = kind.trim();
        let Some((_, usage)) = KINDS.iter().find(|known| known.0 == kind && !words.contains("<!--")) else {
            return Ok(None);
        };
        let mut words: Vec<&str> = words.split_whitespace().collect();
        let kernel = option(&mut words, "--kernel");
        let withheld = option(&mut words, "--withheld");
        let marker = Self { kind, words, kernel: kernel.flatten(), withheld: withheld.flatten(), line };
        let needed = usage.split(' ').count();
        let has_words = marker.words.len() == needed || usage.ends_with("...") && marker.words.len() > needed;
        let takes_kernel = !OF_FIXED_KERNELS.contains(&kind);
        let is_bad = |option: Option<Option<&str>>, is_taken: bool| {
            option.is_some_and(|value| value.is_none() || !is_taken)
        };
        let takes_withheld = kind == OF_WITHHELD;
        if !has_words || is_bad(kernel, takes_kernel) || is_bad(withheld, takes_withheld) {
            let kernel = if takes_kernel { " [--kernel KERNEL]" } else { "" };
            let withheld = if takes_withheld { " [--withheld RESULTS]" } else { "" };
            return Err(marker.wrong(format!("write <!-- {kind}: {usage}{kernel}{withheld} -->")));
        }
        Ok(Some(marker))
    }

    pub fn wrong(&self, reason: String) -> ReadmeError {
        ReadmeError::Marker { line: self.line, reason }
    }

    pub fn content(&self, folder: &Path) -> Result<String, ReadmeError> {
        let results = folder.join(self.words[0]);
        match self.kind {
            // `bars` is an older name.
            "targets" | "bars" => {
                let (rows, is_complete) = self.read_all(&self.words, folder)?;
                Ok(targets::targets(&rows, is_complete))
            }
            "growth" => {
                let growth = targets::growth::growth(&self.read_all(&self.words, folder)?.0);
                if growth.is_empty() {
                    return Err(
                        self.wrong("the rows have no scalable scene; run `phr bench scalable-1M ...`".into())
                    );
                }
                Ok(growth)
            }
            "kernels" | "kernel-targets" => {
                let rows = kernels::row::read(&results).map_err(self.records())?;
                Ok(if self.kind == "kernels" { page(&rows) } else { kernel_targets(&rows) })
            }
            "leaks" => Ok(leaks_table(&kernels::leaks::read(&results).map_err(self.records())?)),
            "scaling" => Ok(report::scaling::page(&scaling::row::read(&results).map_err(self.records())?)),
            "turns" => Ok(by_turns::page(&turns::row::read(&results).map_err(self.records())?)),
            "findings" => findings(&results).map_err(self.records()),
            "advice" => self.advice(folder),
            "measured-advice" => {
                let advice = advice::rows::read_all(&results).map_err(self.records())?;
                let run = row::read(&results).map_err(self.records())?;
                judged_files::page(&run, &advice).map_err(|reason| self.wrong(reason))
            }
            "tuned" => tuned_rows::page(&results).map_err(self.records()),
            "constants" => constants(&results).map_err(|reason| self.wrong(reason)),
            _ => self.of_one_run(folder),
        }
    }

    /// Tells where the marker is whose rows cannot be read.
    fn records(&self) -> impl Fn(RecordsError) -> ReadmeError + use<> {
        let line = self.line;
        move |source| ReadmeError::Records { line, source }
    }

    /// The rows of some results folders and their subfolders, and whether all runs were finished.
    fn read_all(&self, results: &[&str], folder: &Path) -> Result<(Vec<Row>, bool), ReadmeError> {
        let paths: Vec<_> = results.iter().map(|results| folder.join(results)).collect();
        results_dir::read_all(&paths).map_err(self.records())
    }

    /// How good instant advice is: in scenes left out, and with a second folder in withheld ones.
    fn advice(&self, folder: &Path) -> Result<String, ReadmeError> {
        let read = |results: &&str| row::read(&folder.join(results)).map_err(self.records());
        let withheld = self.words.get(1).map(read).transpose()?;
        judged::page(&read(&self.words[0])?, withheld.as_deref()).map_err(|reason| self.wrong(reason))
    }

    fn of_one_run(&self, folder: &Path) -> Result<String, ReadmeError> {
        let results = folder.join(self.words[0]);
        let read = |results: &str| row::read(&folder.join(results)).map_err(self.records());
        let rows = read(self.words[0])?;
        let under = match self.kernel {
            Some(name) => Under::by_name(name, &rows).map_err(|reason| self.wrong(reason))?,
            None => Under::best(&rows),
        };
        if self.kind == "ablation" {
            let told = |reason| self.wrong(reason);
            return Ok(Ablation::of(&rows, self.words[1], &self.words[2..]).map_err(told)?.page());
        }
        let environment = results_dir::environment(&results).map_err(self.records())?;
        let is_complete = results_dir::is_complete(environment.as_ref());
        Ok(match self.kind {
            // The page has headings of its own.
            "table1" => without_title(&table1(&rows, &under)) + &remarks(&rows),
            "means" => without_title(&means(&rows, &under)),
            "scenes" => scenes(&rows).iter().map(|scene| details::scene(&rows, scene) + "\n").collect(),
            "run" => run(&rows, environment.as_ref()),
            "value" => self.value(&rows, &under)?,
            "spread" => {
                spread(&rows, &under).ok_or_else(|| self.wrong("no row has several rounds".into()))?
            }
            "summary" => {
                let withheld = self.withheld.map(read).transpose()?;
                summary(&rows, withheld.as_deref(), &self.words[1..], &under)
                    .map_err(|reason| self.wrong(reason))?
            }
            "holdout" => holdout(&rows, &read(self.words[1])?, &under),
            "assertions" => assertions(&rows, &read(self.words[1])?, &read(self.words[2])?),
            "speedups" => match speedups::table(&rows) {
                table if table.is_empty() => {
                    return Err(self
                        .wrong("no builds on one thread; run `phr bench --build-only --one-thread`".into()));
                }
                table => table,
            },
            "fronts" => fronts(&[("open", &rows), ("withheld", &read(self.words[1])?)]),
            _ => document_under(&rows, is_complete, &under),
        })
    }

    /// A mean over scenes, relative to Embree SAH: `geometric trace phr-hq`.
    fn value(&self, rows: &[Row], under: &Under) -> Result<String, ReadmeError> {
        let (mean, figure, builder) = (self.words[1], self.words[2], self.words[3]);
        let figure = match figure {
            "build" => Figure::Build,
            "cost" => Figure::Cost,
            "frame" => Figure::Frame,
            "trace" => Figure::Trace,
            _ => return Err(self.wrong(format!("no figure {figure}; there are build, cost, frame, trace"))),
        };
        let tree =
            tree_named(builder).ok_or_else(|| self.wrong(format!("{builder}: write NAME or NAME/WIDTH")))?;
        let ratios = Ratios::of(rows, tree, figure, under);
        let none = || self.wrong(format!("the rows have no such figure of {builder} beside Embree SAH"));
        let (some, all) = (ratios.0.len(), scenes(rows).len());
        if (1..all).contains(&some) {
            return Err(self.wrong(format!(
                "{builder} has such a figure in {some} of {all} scenes; a mean over fewer is another mean: take a table, which says so"
            )));
        }
        let value = match mean {
            "arithmetic" => ratios.arithmetic(),
            "geometric" => {
                return ratios.shown().ok_or_else(none);
            }
            "worst" => ratios.worst().map(|worst| worst.value),
            _ => return Err(self.wrong(format!("no mean {mean}; there are arithmetic, geometric, worst"))),
        };
        value.map(|value| format!("{value:.2}")).ok_or_else(none)
    }
}

/// Takes `name` and the word behind it out of `words`; the inner `None` is a name without a word.
fn option<'a>(words: &mut Vec<&'a str>, name: &str) -> Option<Option<&'a str>> {
    let at = words.iter().position(|word| *word == name)?;
    let value = words.get(at + 1).copied();
    words.drain(at..words.len().min(at + 2));
    Some(value)
}

fn without_title(text: &str) -> String {
    text.split_once("\n\n").map_or_else(String::new, |(_, rest)| rest.to_owned())
}

/// When, from what and on what a run was made.
fn run(rows: &[Row], environment: Option<&Environment>) -> String {
    let about = without_title(&heading(rows));
    let Some(environment) = environment else { return about };
    let (machine, library, program) = (&environment.machine, &environment.library, &environment.program);
    let threads = rows.first().map_or(0, |row| row.threads);
    let stopped = if environment.state == State::Complete { "" } else { "\n\nStopped before its end." };
    format!(
        "{}\n\n{}, {threads} of {} processors, {}; {} ({}); {}{stopped}",
        about.trim_end(),
        machine.cpu,
        machine.processors,
        machine.os,
        library.embree_package,
        library.note,
        program.rustc,
    )
}
