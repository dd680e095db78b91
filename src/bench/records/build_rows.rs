//! The rows that tell of a cell's builds, one per regime.

use super::build_times::WarmTimes;
use super::row::{FIRST, FRESH, REBUILD, Row, figures};
use super::samples::CellSamples;
use super::statistics::Summary;
use super::visit_times::{builds, medians, rebuilds};
use super::warnings::Warning;
use crate::bench::cpu_time::CpuTime;

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
        let of_times = |samples: &[f64], times: Vec<&WarmTimes>, threads: u32| {
            let load = sum(times.into_iter().map(|times| times.cpu_time));
            [of_run(samples), Warning::of_cpu_time(&load, threads as usize)].concat()
        };
        let firsts = builds(cell, FIRST);
        let first = with_builds(Row { regime: FIRST.into(), ..known.clone() }, &firsts, &of_run(&firsts));
        let again = builds(cell, REBUILD);
        let warnings = of_times(&again, rebuilds(cell), known.threads);
        let rebuild = with_builds(Row { regime: REBUILD.into(), ..known.clone() }, &again, &warnings);
        let mut others = vec![first, rebuild];
        let alone: Vec<&WarmTimes> =
            cell.visits.iter().filter_map(|visit| visit.builds.one_thread.as_ref()).collect();
        if !alone.is_empty() {
            let times = medians(alone.iter().copied());
            let warnings = of_times(&times, alone, 1);
            // The bytes are those of builds on all threads.
            let row = Row { threads: 1, bytes: None, peak_bytes: None, ..known.clone() };
            others.push(with_builds(row, &times, &warnings));
        }
        let times = builds(cell, FRESH);
        let fresh = cell.visits.iter().map(|visit| &visit.builds.fresh).collect();
        let warnings = of_times(&times, fresh, known.threads);
        Self { compared: with_builds(known, &times, &warnings), warnings, others }
    }
}

fn with_builds(row: Row, samples: &[f64], warnings: &[Warning]) -> Row {
    let Some(summary) = Summary::of(samples) else { return row };
    Row {
        build_ms_median: Some(figures(summary.median)),
        build_ms_mad: Some(figures(summary.mad)),
        build_ms_min: Some(figures(summary.min)),
        build_ms_max: Some(figures(summary.max)),
        build_mtri_s: Some(figures(row.triangles as f64 * 1e-3 / summary.median)),
        warnings: Warning::join(warnings),
        ..row
    }
}

/// CPU time of all.
pub fn sum(times: impl Iterator<Item = CpuTime>) -> CpuTime {
    times.fold(CpuTime::default(), |a, b| CpuTime {
        wall_s: a.wall_s + b.wall_s,
        ran_s: a.ran_s + b.ran_s,
        waited_s: a.waited_s + b.waited_s,
    })
}
