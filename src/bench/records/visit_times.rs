//! One time per visit from its samples: the unit over which medians and spreads are taken.

use super::build_times::{BuildTimes, WarmTimes};
use super::rounds::ByRound;
use super::row::{FIRST, FRESH, REBUILD};
use super::samples::{CellSamples, VisitSamples};
use super::statistics::{figures, median};
use crate::bench::cell::Kernel;
use crate::trace::RayKind;
use std::collections::BTreeMap;

/// Per visit, the build time in a regime; none in a regime of older runs. A visit's builds count as one sample, their
/// median, as its traces do.
pub fn builds(cell: &CellSamples, regime: &str) -> ByRound {
    match regime {
        FIRST => by_round(cell, |visit| Some(visit.builds.first_ms)),
        FRESH => by_round(cell, |visit| median(&visit.builds.fresh.ms)),
        REBUILD => medians(rebuilds(cell).into_iter()),
        _ => Vec::new(),
    }
}

/// The builds that reuse all they can, by round; of Embree's static and dynamic scenes the faster ones.
pub fn rebuilds(cell: &CellSamples) -> Vec<(u32, &WarmTimes)> {
    let of = |times: fn(&BuildTimes) -> Option<&WarmTimes>| -> Vec<(u32, &WarmTimes)> {
        cell.visits.iter().filter_map(|visit| Some((visit.round as u32, times(&visit.builds)?))).collect()
    };
    let (same, dynamic) = (of(|times| Some(&times.rebuild)), of(|times| times.dynamic_rebuild.as_ref()));
    let middle = |times: &[(u32, &WarmTimes)]| median(&all_ms(&medians(times.iter().copied())));
    match (middle(&same), middle(&dynamic)) {
        (Some(of_same), Some(of_dynamic)) if of_dynamic < of_same => dynamic,
        _ => same,
    }
}

/// The median of each round with any builds.
pub fn medians<'a>(times: impl Iterator<Item = (u32, &'a WarmTimes)>) -> ByRound {
    times.filter_map(|(round, times)| Some((round, median(&times.ms)?))).collect()
}

/// Per visit, what `time` says of it; visits of which it says nothing are left out.
fn by_round(cell: &CellSamples, time: impl Fn(&VisitSamples) -> Option<f64>) -> ByRound {
    cell.visits.iter().filter_map(|visit| Some((visit.round as u32, time(visit)?))).collect()
}

/// The times with the digits that rows have.
pub fn rounded(times: ByRound) -> ByRound {
    times.into_iter().map(|(round, ms)| (round, figures(ms))).collect()
}

/// The times alone.
pub fn all_ms(times: &[(u32, f64)]) -> Vec<f64> {
    times.iter().map(|time| time.1).collect()
}

/// Per visit, the time of all matching traces of a pass together, the median of its passes; visits without any are
/// left out.
pub fn times(
    cell: &CellSamples,
    kernel: Kernel,
    view: Option<usize>,
    kind: impl Fn(Option<RayKind>) -> bool,
) -> ByRound {
    let of_visit = |visit: &VisitSamples| {
        let matching = visit.timings.iter().filter(|timing| {
            timing.kernel == kernel && view.is_none_or(|view| view == timing.view) && kind(timing.kind)
        });
        // By number, which a file may have any of.
        let mut passes = BTreeMap::<usize, f64>::new();
        for timing in matching {
            *passes.entry(timing.pass).or_default() += timing.ms;
        }
        median(&passes.into_values().collect::<Vec<_>>())
    };
    by_round(cell, of_visit)
}
