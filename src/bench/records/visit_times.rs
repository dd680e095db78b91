//! One time per visit from its samples: the unit over which medians and spreads are taken.

use super::build_times::{BuildTimes, WarmTimes};
use super::row::{FIRST, FRESH, REBUILD};
use super::samples::{CellSamples, VisitSamples};
use super::statistics::median;
use crate::bench::cell::Kernel;
use crate::trace::RayKind;

/// Per visit, the build time in a regime; none in a regime of older runs. A visit's builds count as one sample, their
/// median, as its traces do.
pub fn builds(cell: &CellSamples, regime: &str) -> Vec<f64> {
    let times = cell.visits.iter().map(|visit| &visit.builds);
    match regime {
        FIRST => times.map(|times| times.first_ms).collect(),
        FRESH => medians(times.map(|times| &times.fresh)),
        REBUILD => medians(rebuilds(cell).into_iter()),
        _ => Vec::new(),
    }
}

/// The builds that reuse all they can; of Embree's static and dynamic scenes the faster ones.
pub fn rebuilds(cell: &CellSamples) -> Vec<&WarmTimes> {
    let of = |times: fn(&BuildTimes) -> Option<&WarmTimes>| -> Vec<&WarmTimes> {
        cell.visits.iter().filter_map(|visit| times(&visit.builds)).collect()
    };
    let (same, dynamic) = (of(|times| Some(&times.rebuild)), of(|times| times.dynamic_rebuild.as_ref()));
    let middle = |times: &[&WarmTimes]| median(&medians(times.iter().copied()));
    match (middle(&same), middle(&dynamic)) {
        (Some(of_same), Some(of_dynamic)) if of_dynamic < of_same => dynamic,
        _ => same,
    }
}

/// The median of each visit with any builds.
pub fn medians<'a>(times: impl Iterator<Item = &'a WarmTimes>) -> Vec<f64> {
    times.filter_map(|times| median(&times.ms)).collect()
}

/// Per visit, the time of all matching traces of a pass together, the median of its passes; visits without any are
/// left out.
pub fn times(
    cell: &CellSamples,
    kernel: Kernel,
    view: Option<usize>,
    kind: impl Fn(Option<RayKind>) -> bool,
) -> Vec<f64> {
    let of_visit = |visit: &VisitSamples| {
        let matching = visit.timings.iter().filter(|timing| {
            timing.kernel == kernel && view.is_none_or(|view| view == timing.view) && kind(timing.kind)
        });
        let mut passes = Vec::new();
        for timing in matching {
            if passes.len() <= timing.pass {
                passes.resize(timing.pass + 1, 0.0);
            }
            passes[timing.pass] += timing.ms;
        }
        median(&passes)
    };
    cell.visits.iter().filter_map(of_visit).collect()
}
