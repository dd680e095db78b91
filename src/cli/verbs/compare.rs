//! `phr compare`: two runs, figure by figure.

use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::report::compare::{Outcome, Recorded, Verdict};
use std::path::PathBuf;

/// Compare the times of results B with those of A; exit code 0 if none is slower, 1 if some are, 3 if undecided
///
/// Each verdict follows from the 95 % interval of the ratio of medians: by bootstrap over samples.json, widened
/// where samples are few, or from median and deviation in rows.csv where there are no samples.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Results before: a folder, or a rows.csv
    a: PathBuf,
    /// Results after
    b: PathBuf,
    /// Changes up to this count as the same
    #[arg(long, default_value = "5%", value_name = "PERCENT", value_parser = percent)]
    threshold: f64,
    /// Compare sums over views and kinds of rays only
    #[arg(long)]
    totals: bool,
    /// Show figures that are the same too
    #[arg(long)]
    all: bool,
}

/// "5%" as 0.05.
fn percent(text: &str) -> Result<f64, String> {
    let value = text.strip_suffix('%').and_then(|number| number.trim().parse::<f64>().ok());
    match value {
        Some(value) if value >= 0.0 && value.is_finite() => Ok(0.01 * value),
        _ => Err("give a percentage, as 5%".into()),
    }
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (a, b) = (Recorded::read(&arguments.a)?, Recorded::read(&arguments.b)?);
    let outcome = Outcome::of(&a, &b, arguments.threshold, arguments.totals);
    say(&outcome.document(arguments.threshold, arguments.all))?;
    if outcome.comparisons.is_empty() && outcome.failures.is_empty() {
        let (a, b) = (arguments.a.display(), arguments.b.display());
        return Err(Failure::Bad(format!("{a}, {b}: no figure in common; give two runs of the same scenes")));
    }
    let verdict = |what: &str| format!("{what}: {}", outcome.summary(arguments.threshold));
    if outcome.count(Verdict::Slower) + outcome.failures.len() > 0 {
        Err(Failure::Wrong(verdict("slower")))
    } else if outcome.count(Verdict::Inconclusive) > 0 {
        Err(Failure::Inconclusive(verdict("inconclusive")))
    } else {
        Ok(())
    }
}
