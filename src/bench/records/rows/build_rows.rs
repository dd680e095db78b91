//! The rows that tell of a cell's builds, one per regime.

use crate::bench::build_times::WarmTimes;
use crate::bench::hardware_counters::Counted;
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
        let rebuild = with_processors(rebuild, rebuilds(cell).into_iter().map(|of_round| of_round.1));
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
            others.push(with_processors(row, alone.into_iter().map(|of_round| of_round.1)));
        }
        let times = builds(cell, FRESH);
        let fresh = || cell.visits.iter().map(|visit| &visit.builds.fresh);
        let warnings = of_times(&times, fresh().collect(), known.threads);
        let compared = with_processors(with_builds(known, &times, &warnings), fresh());
        Self { compared, warnings, others }
    }
}

/// The row with what its builds took of processors, where system and machine tell it.
fn with_processors<'a>(row: Row, builds: impl Iterator<Item = &'a WarmTimes>) -> Row {
    let builds: Vec<&WarmTimes> = builds.collect();
    let count: usize = builds.iter().map(|builds| builds.ms.len()).sum();
    let per_triangle = |all: f64| {
        let each = figures(all / (count as f64 * row.triangles as f64));
        Some(each).filter(|each| *each > 0.0 && each.is_finite())
    };
    let counted: Option<Vec<Counted>> = builds.iter().map(|builds| builds.counted).collect();
    let sum = |of: fn(&Counted) -> u64| {
        let all = counted.as_ref()?.iter().map(of).sum::<u64>();
        per_triangle(all as f64)
    };
    Row {
        build_cpu_ns_per_tri: per_triangle(
            1e9 * builds.iter().map(|builds| builds.cpu_time.ran_s).sum::<f64>(),
        ),
        build_instructions_per_tri: sum(|counted| counted.instructions),
        build_cycles_per_tri: sum(|counted| counted.cycles),
        ..row
    }
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
