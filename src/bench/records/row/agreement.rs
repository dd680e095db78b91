//! Whether what was written of a run still agrees: a figure with the rounds that it sums up, the rows of a scene with
//! one another. So a figure changed by hand is found, and rows of two runs in one file are.

use super::Row;
use crate::bench::files::RecordsError;
use crate::bench::rounds::ByRound;
use crate::bench::statistics::Summary;
use std::collections::HashMap;
use std::path::Path;

/// How far a figure may be from that of its rounds, as a share of the median: all are rounded to six digits.
const ROUNDING: f64 = 1e-4;

/// Refuses a row on the line `line` of the file `path` whose figures are not those of its rounds.
pub(super) fn check_rounds(path: &Path, line: usize, row: &Row) -> Result<(), RecordsError> {
    let of = [
        ("build", row.build_figures(), &row.by_round.build),
        ("trace", row.trace_figures(), &row.by_round.trace),
        ("frame", row.frame_figures(), &row.by_round.frame),
    ];
    of.into_iter().try_for_each(|(figure, told, rounds)| {
        let Some(Summary { median, mad, min, max, .. }) = summary(rounds) else { return Ok(()) };
        let of_rounds = [median, mad, min, max];
        let mut pairs = ["median", "mad", "min", "max"].into_iter().zip(told.into_iter().zip(of_rounds));
        let is_other =
            |told: Option<f64>, is: f64| told.is_none_or(|told| (told - is).abs() > ROUNDING * median);
        pairs.find(|(_, (told, is))| is_other(*told, *is)).map_or(Ok(()), |(what, (told, of_rounds))| {
            let column = format!("{figure}_ms_{what}");
            let told = told.map_or_else(|| "empty".to_owned(), |told| told.to_string());
            Err(RecordsError::Changed { path: path.to_owned(), line, column, told, of_rounds })
        })
    })
}

fn summary(rounds: &ByRound) -> Option<Summary> {
    Summary::of(&rounds.iter().map(|(_, ms)| *ms).collect::<Vec<_>>())
}

/// Refuses rows of a scene that are of two runs. Scenes may be of different runs, as of shards.
pub(super) fn check_runs(path: &Path, rows: &[Row]) -> Result<(), RecordsError> {
    let mut runs: HashMap<&str, &str> = HashMap::new();
    rows.iter().enumerate().try_for_each(|(i, row)| {
        let run = *runs.entry(&row.scene).or_insert(&row.run_id);
        if run == row.run_id {
            return Ok(());
        }
        let (scene, runs) = (row.scene.clone(), [run.to_owned(), row.run_id.clone()]);
        Err(RecordsError::TwoRuns { path: path.to_owned(), line: i + 2, scene, runs })
    })
}
