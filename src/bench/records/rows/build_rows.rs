//! The rows that tell of a cell's builds, one per regime.

use crate::bench::build_times::WarmTimes;
use crate::bench::rounds::{ByRound, RowRounds};
use crate::bench::row::{FIRST, FRESH, REBUILD, Row};
use crate::bench::samples::CellSamples;
use crate::bench::statistics::{Summary, figures};
use crate::bench::visit_times::{all_ms, builds, medians, rebuilds, rounded};
use crate::bench::warnings::Warning;

/// The rows of builds.
pub struct BuildRows {
    /// The regime by which builders are compared; its traces are told in copies of this row.
    pub compared: Row,
    /// Its warnings.
    pub warnings: Vec<Warning>,
    /// The other regimes, and fresh builds on one thread where they were timed.
    pub others: Vec<Row>,
}

impl BuildRows {
    /// The rows of `cell`, what is known of it beside times in `known`; `of_run` gives the warnings of samples.
    pub fn of(cell: &CellSamples, known: Row, of_run: impl Fn(&[f64]) -> Vec<Warning>) -> Self {
        let of_times = |times: &ByRound, builds: Vec<&WarmTimes>, threads: u32| {
            let load = builds.into_iter().map(|builds| builds.cpu_time).sum();
            [of_run(&all_ms(times)), Warning::of_cpu_time(&load, threads as usize)].concat()
        };
        let firsts = builds(cell, FIRST);
        let warnings = of_run(&all_ms(&firsts));
        let first = with_builds(Row { regime: FIRST.into(), ..known.clone() }, &firsts, &warnings);
        let again = builds(cell, REBUILD);
        let load = rebuilds(cell).into_iter().map(|of_round| of_round.1).collect();
        let warnings = of_times(&again, load, known.threads);
        let rebuild = with_builds(Row { regime: REBUILD.into(), ..known.clone() }, &again, &warnings);
        let rebuild = with_cpu_time(rebuild, rebuilds(cell).into_iter().map(|of_round| of_round.1));
        let mut others = vec![first, rebuild];
        let visits = cell.visits.iter();
        let alone: Vec<(u32, &WarmTimes)> = visits
            .filter_map(|visit| Some((visit.round as u32, visit.builds.one_thread.as_ref()?)))
            .collect();
        if !alone.is_empty() {
            let times = medians(alone.iter().copied());
            let warnings = of_times(&times, alone.iter().map(|of_round| of_round.1).collect(), 1);
            // The bytes are those of builds on all threads.
            let row = Row { threads: 1, bytes: None, peak_bytes: None, ..known.clone() };
            let row = with_builds(row, &times, &warnings);
            others.push(with_cpu_time(row, alone.into_iter().map(|of_round| of_round.1)));
        }
        let times = builds(cell, FRESH);
        let fresh = || cell.visits.iter().map(|visit| &visit.builds.fresh);
        let warnings = of_times(&times, fresh().collect(), known.threads);
        let compared = with_cpu_time(with_builds(known, &times, &warnings), fresh());
        Self { compared, warnings, others }
    }
}

/// The row with the CPU time of its builds, where the system tells it.
fn with_cpu_time<'a>(row: Row, builds: impl Iterator<Item = &'a WarmTimes>) -> Row {
    let (count, ran_s) =
        builds.fold((0, 0.0), |(count, ran_s), of| (count + of.ms.len(), ran_s + of.cpu_time.ran_s));
    let per_triangle = figures(ran_s * 1e9 / (count as f64 * row.triangles as f64));
    Row { build_cpu_ns_per_tri: Some(per_triangle).filter(|ns| *ns > 0.0 && ns.is_finite()), ..row }
}

fn with_builds(row: Row, times: &ByRound, warnings: &[Warning]) -> Row {
    let Some(summary) = Summary::of(&all_ms(times)) else { return row };
    Row {
        build_ms_median: Some(figures(summary.median)),
        build_ms_mad: Some(figures(summary.mad)),
        build_ms_min: Some(figures(summary.min)),
        build_ms_max: Some(figures(summary.max)),
        build_mtri_s: Some(figures(row.triangles as f64 * 1e-3 / summary.median)),
        warnings: Warning::join(warnings),
        by_round: RowRounds { build: rounded(times.clone()), ..RowRounds::default() },
        ..row
    }
}
