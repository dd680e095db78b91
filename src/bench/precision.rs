//! Whether a scene was measured often enough: the intervals of its ratios, paired within rounds.

use super::cell::Kernel;
use super::rounds::{ByRound, paired};
use super::row::FRESH;
use super::samples::{CellSamples, SceneSamples};
use super::turns::paired::PairedMean;
use super::visit_times::{builds, times};

/// The tree that ratios are to; the first where it was not measured.
const BASE: (&str, u32) = ("embree-sah", 4);

/// Half the widest 95 % interval among the scene's ratios of build and trace times, relative to the ratio; infinite
/// after one round.
pub fn widest(scene: &SceneSamples) -> f64 {
    let cells: Vec<&CellSamples> = scene.cells.iter().filter(|cell| !cell.failed()).collect();
    let is_base = |cell: &&&CellSamples| (cell.cell.builder.as_str(), cell.cell.width) == BASE;
    let Some(base) = cells.iter().find(is_base).or(cells.first()) else { return 0.0 };
    let others = cells.iter().filter(|cell| cell.cell != base.cell);
    let pairs = others.flat_map(|cell| figures(cell).into_iter().zip(figures(base)));
    pairs.map(|(a, b)| half_width(&a, &b)).fold(0.0, f64::max)
}

/// The times by which a tree is compared: of its builds, and of its traces under each kernel.
fn figures(cell: &CellSamples) -> Vec<ByRound> {
    let traces = Kernel::ALL.map(|kernel| times(cell, kernel, None, |kind| kind.is_some()));
    [builds(cell, FRESH)].into_iter().chain(traces).collect()
}

/// Nothing is wide where one of them was not measured.
fn half_width(a: &ByRound, b: &ByRound) -> f64 {
    if a.is_empty() || b.is_empty() {
        return 0.0;
    }
    let logs: Vec<f64> = paired(a, b).iter().map(|[a, b]| (a / b).ln()).collect();
    PairedMean::of([&logs[..]].into_iter()).half_width()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drift_is_no_reason_to_go_on() {
        let base: ByRound = vec![(0, 10.0), (1, 20.0), (2, 15.0)];
        let half: ByRound = base.iter().map(|&(round, ms)| (round, 0.5 * ms)).collect();
        assert!(half_width(&half, &base) < 1e-12);
        let noisy: ByRound = vec![(0, 10.0), (1, 21.0), (2, 15.0)];
        let width = half_width(&noisy, &base);
        assert!(0.05 < width && width < 0.2, "{width}");
        assert_eq!(half_width(&noisy, &Vec::new()), 0.0);
        assert_eq!(half_width(&noisy[..1].to_vec(), &base), f64::INFINITY);
    }
}
