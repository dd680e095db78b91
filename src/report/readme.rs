//! Figures within Markdown pages: the text between two markers is generated from committed rows, and a check tells
//! whether it still agrees with them. `results/README.md` describes the markers.

use super::ablation::Ablation;
use super::figures::{Figure, Under, scenes, tree_named};
use super::means::{Ratios, means};
use super::summary::summary;
use super::table::{document_under, heading, remarks};
use super::table1::table1;
use super::{details, targets};
use crate::bench::environment::{Environment, State};
use crate::bench::files::RecordsError;
use crate::bench::kernels;
use crate::bench::results_dir;
use crate::bench::row::{self, Row};
use std::path::Path;

const END: &str = "<!-- end -->";
/// The kinds of markers, each with the words that follow; `...` stands for more of the last.
const KINDS: [(&str, &str); 12] = [
    ("table", "RESULTS"),
    ("table1", "RESULTS"),
    ("means", "RESULTS"),
    ("scenes", "RESULTS"),
    ("run", "RESULTS"),
    ("value", "RESULTS MEAN FIGURE BUILDER"),
    ("summary", "RESULTS BUILDER..."),
    ("targets", "RESULTS..."),
    ("bars", "RESULTS..."),
    ("growth", "RESULTS"),
    ("ablation", "RESULTS BASE BUILDER..."),
    ("kernels", "RESULTS"),
];
/// Kinds with fixed kernels, which take no `--kernel`.
const OF_FIXED_KERNELS: [&str; 5] = ["targets", "bars", "growth", "ablation", "kernels"];

/// Why a text cannot be regenerated.
#[derive(Debug, thiserror::Error)]
pub enum ReadmeError {
    /// The rows cannot be read.
    #[error("line {line}: {source}")]
    Records {
        /// Line of the marker.
        line: usize,
        /// The cause.
        source: RecordsError,
    },
    /// A marker cannot be understood.
    #[error("line {line}: {reason}")]
    Marker {
        /// Its line.
        line: usize,
        /// The mistake, and the remedy.
        reason: String,
    },
    /// No marker at all: there would be nothing to check.
    #[error("no marker; write `<!-- table1: RESULTS -->` and `<!-- end -->` around the generated text")]
    None,
}

/// Generates the text between all markers of `text` again. Results are relative to `folder`, the page's own.
///
/// # Errors
/// Markers that cannot be understood, rows that cannot be read, or no marker.
pub fn regenerate(text: &str, folder: &Path) -> Result<String, ReadmeError> {
    let mut out = String::new();
    let (mut is_code, mut blocks) = (false, 0);
    let mut lines = text.lines().enumerate();
    while let Some((index, content)) = lines.next() {
        let line = index + 1;
        is_code ^= content.trim_start().starts_with("```");
        if is_code || !content.contains("<!--") {
            out += &format!("{content}\n");
        } else if let Some(marker) = Marker::of(content.trim(), line)? {
            // A block: all lines up to the end's.
            let until = lines.by_ref().find(|(_, line)| line.trim() == END || Marker::starts(line));
            if until.is_none_or(|(_, line)| line.trim() != END) {
                return Err(marker.wrong(format!("{} without {END} on a line of its own", marker.kind)));
            }
            out += &format!("{content}\n{}\n{END}\n", marker.content(folder)?.trim_end());
            blocks += 1;
        } else {
            let (content, count) = inline(content, line, folder)?;
            out += &format!("{content}\n");
            blocks += count;
        }
    }
    if blocks == 0 { Err(ReadmeError::None) } else { Ok(out) }
}

/// A line with the text between its markers generated again, and their number.
fn inline(mut rest: &str, line: usize, folder: &Path) -> Result<(String, usize), ReadmeError> {
    let (mut out, mut count) = (String::new(), 0);
    while let Some(start) = rest.find("<!--") {
        let Some(length) = rest[start..].find("-->") else { break };
        let after = start + length + "-->".len();
        let comment = &rest[start..after];
        out += &rest[..after];
        rest = &rest[after..];
        let Some(marker) = Marker::of(comment, line)? else {
            if comment == END {
                let kinds = KINDS.map(|kind| kind.0).join(", ");
                let reason = format!("{END} without a beginning; there are {kinds}");
                return Err(ReadmeError::Marker { line, reason });
            }
            continue;
        };
        let end = rest.find(END).ok_or_else(|| marker.wrong(format!("{} without {END}", marker.kind)))?;
        out += &(marker.content(folder)? + END);
        rest = &rest[end + END.len()..];
        count += 1;
    }
    Ok((out + rest, count))
}

/// A marker, taken apart.
struct Marker<'a> {
    kind: &'a str,
    words: Vec<&'a str>,
    kernel: Option<&'a str>,
    line: usize,
}

impl<'a> Marker<'a> {
    fn starts(line: &str) -> bool {
        Marker::of(line.trim(), 0).is_ok_and(|marker| marker.is_some())
    }

    /// `<!-- KIND: WORDS [--kernel KERNEL] -->`; other comments are none.
    fn of(comment: &'a str, line: usize) -> Result<Option<Self>, ReadmeError> {
        let inside = comment.strip_prefix("<!--").and_then(|rest| rest.strip_suffix("-->"));
        let Some((kind, words)) = inside.and_then(|inside| inside.split_once(':')) else { return Ok(None) };
        let kind = kind.trim();
        let Some((_, usage)) = KINDS.iter().find(|known| known.0 == kind && !words.contains("<!--")) else {
            return Ok(None);
        };
        let mut words: Vec<&str> = words.split_whitespace().collect();
        let kernel = words.iter().position(|word| *word == "--kernel").map(|at| {
            let kernel = words.get(at + 1).copied();
            words.drain(at..words.len().min(at + 2));
            kernel
        });
        let marker = Self { kind, words, kernel: kernel.flatten(), line };
        let needed = usage.split(' ').count();
        let has_words = marker.words.len() == needed || usage.ends_with("...") && marker.words.len() > needed;
        let takes_kernel = !OF_FIXED_KERNELS.contains(&kind);
        if !has_words || kernel.is_some_and(|name| name.is_none() || !takes_kernel) {
            let option = if takes_kernel { " [--kernel KERNEL]" } else { "" };
            return Err(marker.wrong(format!("write <!-- {kind}: {usage}{option} -->")));
        }
        Ok(Some(marker))
    }

    fn wrong(&self, reason: String) -> ReadmeError {
        ReadmeError::Marker { line: self.line, reason }
    }

    fn content(&self, folder: &Path) -> Result<String, ReadmeError> {
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
            "kernels" => {
                let rows = kernels::row::read(&folder.join(self.words[0]));
                let rows = rows.map_err(|source| ReadmeError::Records { line: self.line, source })?;
                Ok(super::kernels::page(&rows))
            }
            _ => self.of_one_run(folder),
        }
    }

    /// The rows of some results folders and their subfolders, and whether all runs were finished.
    fn read_all(&self, results: &[&str], folder: &Path) -> Result<(Vec<Row>, bool), ReadmeError> {
        let paths: Vec<_> = results.iter().map(|results| folder.join(results)).collect();
        results_dir::read_all(&paths).map_err(|source| ReadmeError::Records { line: self.line, source })
    }

    fn of_one_run(&self, folder: &Path) -> Result<String, ReadmeError> {
        let results = folder.join(self.words[0]);
        let records = |source| ReadmeError::Records { line: self.line, source };
        let rows = row::read(&results).map_err(records)?;
        let under = match self.kernel {
            Some(name) => Under::by_name(name, &rows).map_err(|reason| self.wrong(reason))?,
            None => Under::best(&rows),
        };
        if self.kind == "ablation" {
            let told = |reason| self.wrong(reason);
            return Ok(Ablation::of(&rows, self.words[1], &self.words[2..]).map_err(told)?.page());
        }
        let environment = results_dir::environment(&results).map_err(records)?;
        let is_complete = results_dir::is_complete(environment.as_ref());
        Ok(match self.kind {
            // The page has headings of its own.
            "table1" => without_title(&table1(&rows, &under)) + &remarks(&rows),
            "means" => without_title(&means(&rows, &under)),
            "scenes" => scenes(&rows).iter().map(|scene| details::scene(&rows, scene) + "\n").collect(),
            "run" => run(&rows, environment.as_ref()),
            "value" => self.value(&rows, &under)?,
            "summary" => summary(&rows, &self.words[1..], &under).map_err(|reason| self.wrong(reason))?,
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
        let value = match mean {
            "arithmetic" => ratios.arithmetic(),
            "geometric" => ratios.geometric(),
            "worst" => ratios.worst().map(|worst| worst.1),
            _ => return Err(self.wrong(format!("no mean {mean}; there are arithmetic, geometric, worst"))),
        };
        let none = || self.wrong(format!("the rows have no such figure of {builder} beside Embree SAH"));
        value.map(|value| format!("{value:.2}")).ok_or_else(none)
    }
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

/// Lines that differ, as `-` what stands there and `+` what should, at most twenty.
pub fn differences(old: &str, new: &str) -> String {
    let (old, new): (Vec<&str>, Vec<&str>) = (old.lines().collect(), new.lines().collect());
    let same_tail = |(a, b): &(&&str, &&str)| a == b;
    let head = old.iter().zip(&new).take_while(|(a, b)| a == b).count();
    let tail = old[head..].iter().rev().zip(new[head..].iter().rev()).take_while(same_tail).count();
    let (old, new) = (&old[head..old.len() - tail], &new[head..new.len() - tail]);
    let mut lines: Vec<String> = Vec::new();
    for index in 0..old.len().max(new.len()) {
        let (a, b) = (old.get(index), new.get(index));
        if a != b {
            lines.extend(a.map(|line| format!("{:>5} -{line}", head + index + 1)));
            lines.extend(b.map(|line| format!("{:>5} +{line}", head + index + 1)));
        }
    }
    if lines.len() > 20 {
        lines.truncate(20);
        lines.push("      ...".into());
    }
    lines.join("\n")
}
