//! What verbs that measure share: a run that Ctrl-C stops, and what its end means.

use super::failure::Failure;
use super::progress::Bar;
use crate::bench::plan::Plan;
use crate::bench::recorder::RecordOptions;
use crate::bench::row::Row;
use crate::bench::run::{Outcome, Run};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Makes a run, which `bar` shows; `program` measures the bytes of builds.
///
/// # Errors
/// Those of [`Run::make`]; stopped before the first visit.
pub fn make(
    plan: &Plan,
    records: RecordOptions<'_>,
    program: Option<&Path>,
    mut bar: Bar,
) -> Result<Outcome, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let heard = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        // A second Ctrl-C ends at once: the files on disk are whole at any time.
        if heard.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })?;
    let outcome = Run { plan, records, program, stop: &stop }.make(&mut bar)?;
    bar.finish();
    if outcome.rows.is_empty() {
        return Err(Failure::Interrupted("stopped before the first visit was done; no rows".into()));
    }
    Ok(outcome)
}

/// What the end of a run means for the exit code.
///
/// # Errors
/// Builders that failed, wrong hits, a run that was stopped.
pub fn verdict(rows: &[Row], failures: usize, complete: bool, folder: &Path) -> Result<(), Failure> {
    if failures > 0 {
        let first = rows
            .iter()
            .find(|row| row.verified == Some(false))
            .or_else(|| rows.iter().find(|row| !row.error.is_empty()));
        let first = first.map_or_else(String::new, |row| {
            format!("first {} {}/{}: {}", row.scene, row.builder, row.width, row.error)
        });
        return Err(Failure::Wrong(format!("{failures} builders failed or have wrong hits; {first}")));
    }
    if !complete {
        let folder = folder.display();
        return Err(Failure::Interrupted(format!(
            "{folder}: stopped; finished visits are kept, continue with --resume"
        )));
    }
    Ok(())
}
