//! `phr compare`: two runs, figure by figure, or two programs by turns.

use crate::bench::contender;
use crate::bench::files::new_folder;
use crate::bench::planned_scene::PlannedScene;
use crate::bench::run::Progress;
use crate::bench::turns::{Measured, Turns};
use crate::cli::failure::Failure;
use crate::cli::options::{Made, all_threads, cells, check_threads, percent, seconds, width};
use crate::cli::output::say;
use crate::cli::progress::Bar;
use crate::report::compare::by_turns::{ByTurns, THRESHOLD};
use crate::report::compare::{Change, Outcome, Recorded};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Compare the times of results B with those of A, or this program with another; exit code 0 if nothing is slower, 1 if
/// something is, 3 if undecided
///
/// Of results, each verdict follows from the 95 % interval of B / A: where both runs have rounds in common, B / A is
/// the mean of the ratios of their rounds, which need not be the quotient of the medians beside it. Else it is the
/// ratio of medians, by bootstrap over samples.json, widened where samples are few, or from median and deviation in
/// rows.csv.
///
/// With --against, two builds of this program build the scenes by turns, this one as B; each verdict follows from the
/// interval of the paired ratios. That finds smaller changes sooner.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Results before and results after, each a folder or a rows.csv; with --against, scenes
    #[arg(required = true, value_name = "RESULTS|SCENE")]
    places: Vec<String>,
    /// Another build of this program, measured beside this one as A
    #[arg(long, value_name = "BINARY")]
    against: Option<PathBuf>,
    /// With --against: only this builder (repeatable) [default: ours in the tables]
    #[arg(long = "builder", value_name = "NAME", requires = "against")]
    builders: Vec<String>,
    /// With --against: the builder with this field of its configuration changed (repeatable): BUILDER.FIELD=VALUE
    #[arg(long = "set", value_name = "CHANGE", requires = "against")]
    changes: Vec<String>,
    /// With --against: the builder of this file (repeatable): {"name": NAME, "base": BUILDER, "fields": {"FIELD":
    /// VALUE}}
    #[arg(long = "config", value_name = "FILE", requires = "against")]
    configs: Vec<PathBuf>,
    /// With --against: children per node (repeatable) [default: 4, or the one width that a builder has]
    #[arg(long = "width", value_name = "N", value_parser = width, requires = "against")]
    widths: Vec<u32>,
    /// With --against: threads [default: all processors]
    #[arg(long, value_name = "N", requires = "against")]
    threads: Option<usize>,
    /// With --against: sessions are added to the first five until every interval is within half the threshold, or this
    /// time is over
    #[arg(long, default_value_t = 600, value_name = "N", value_parser = seconds, requires = "against")]
    seconds: u64,
    /// With --against: folder that keeps every session, as turns.csv [default: none]
    #[arg(long, value_name = "DIR", requires = "against")]
    out: Option<PathBuf>,
    /// Changes up to this count as the same [default: 5%; with --against 2%]
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    threshold: Option<f64>,
    /// Compare sums over views and kinds of rays only
    #[arg(long, conflicts_with = "against")]
    totals: bool,
    /// Show figures that are the same too
    #[arg(long, conflicts_with = "against")]
    all: bool,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match (&arguments.against, &arguments.places[..]) {
        (Some(before), _) => by_turns(arguments, before),
        (None, [a, b]) => results(arguments, Path::new(a), Path::new(b)),
        (None, _) => Err(Failure::Bad("give two results folders, or a program with --against".into())),
    }
}

fn results(arguments: &Arguments, a: &Path, b: &Path) -> Result<(), Failure> {
    let threshold = arguments.threshold.unwrap_or(0.05);
    let outcome = Outcome::of(&Recorded::read(a)?, &Recorded::read(b)?, threshold, arguments.totals);
    say(&outcome.document(threshold, arguments.all))?;
    if outcome.comparisons.is_empty() && outcome.failures.is_empty() {
        let (a, b) = (a.display(), b.display());
        return Err(Failure::Bad(format!("{a}, {b}: no figure in common; give two runs of the same scenes")));
    }
    let count = |verdict| outcome.count(verdict);
    let slower = count(Change::Slower) + outcome.failures.len();
    // What B lacks may be what got slower.
    verdict(slower, count(Change::Inconclusive) + outcome.unmatched[0], &outcome.summary(threshold))
}

fn by_turns(arguments: &Arguments, before: &Path) -> Result<(), Failure> {
    let threshold = arguments.threshold.unwrap_or(THRESHOLD);
    let threads = arguments.threads.unwrap_or_else(all_threads);
    check_threads(threads)?;
    let scenes = PlannedScene::find_all(&arguments.places)?;
    let names: Vec<String> = scenes.into_iter().map(|scene| scene.name).collect();
    let widths = if arguments.widths.is_empty() { &[4][..] } else { &arguments.widths };
    let ours = contender::cells(true).into_iter().filter(|cell| {
        crate::builders::NAMES.contains(&cell.builder.as_str()) && widths.contains(&cell.width)
    });
    let made = Made { changes: arguments.changes.clone(), configs: arguments.configs.clone() };
    let named = cells(&arguments.builders, &made, &arguments.widths)?;
    let cells = if named.is_empty() { ours.collect() } else { named };
    if let Some(out) = &arguments.out {
        new_folder(out)?;
    }
    let this = std::env::current_exe()?;
    let turns = Turns {
        programs: [before, &this],
        scenes: &arguments.places,
        names: &names,
        cells: &cells,
        threads,
        precision: 0.5 * threshold,
        limit: Duration::from_secs(arguments.seconds),
        out: arguments.out.as_deref(),
    };
    let mut bar = Bar::new(false);
    bar.begin(arguments.seconds);
    let mut shown = 0;
    let measured = turns.measure(&mut |doing, spent| {
        bar.at(doing);
        bar.advance(spent.as_secs().saturating_sub(shown));
        shown = spent.as_secs();
    });
    bar.finish();
    let Measured { rows, is_precise } = measured?;
    let judged = ByTurns::of(&rows, threshold);
    say(&judged.document())?;
    if !is_precise {
        let seconds = arguments.seconds;
        say(&format!(
            "The {seconds} s were over before every interval was narrow; --seconds N gives more.\n"
        ))?;
    }
    verdict(judged.count(Change::Slower), judged.count(Change::Inconclusive), &judged.summary())
}

/// The exit code's reason.
fn verdict(slower: usize, undecided: usize, summary: &str) -> Result<(), Failure> {
    if slower > 0 {
        Err(Failure::Wrong(format!("slower: {summary}")))
    } else if undecided > 0 {
        Err(Failure::Inconclusive(format!("inconclusive: {summary}")))
    } else {
        Ok(())
    }
}
