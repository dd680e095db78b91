//! One time per visit from its samples: the unit over which medians and spreads are taken.

use super::row::COLD;
use super::samples::{CellSamples, VisitSamples};
use super::statistics::median;
use crate::bench::cell::Kernel;
use crate::trace::RayKind;

/// Per visit, the build time in a regime. A visit's warm builds count as one sample, their median, as its
/// traces do.
pub fn builds(cell: &CellSamples, regime: &str) -> Vec<f64> {
    if regime == COLD {
        return cell.visits.iter().map(|visit| visit.builds.cold_ms).collect();
    }
    cell.visits.iter().filter_map(|visit| median(&visit.builds.warm.ms)).collect()
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
