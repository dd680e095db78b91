//! The rows of one tree under one kernel.

use crate::bench::rounds::RowRounds;
use crate::bench::row::{ALL, Row};
use crate::bench::samples::{CellSamples, Check, KernelChecks};
use crate::bench::statistics::{Summary, figures};
use crate::bench::visit_times::{all_ms, rounded, times};
use crate::bench::warnings::Warning;
use crate::trace::RayKind;

/// One row per view and kind, and those that sum over views, kinds or both.
pub fn kernel_rows(
    row: &Row,
    warnings: &[Warning],
    kernel: &KernelChecks,
    cell: &CellSamples,
    views: usize,
) -> Vec<Row> {
    let views = || (0..views).map(Some).chain([None]);
    let kinds = || RayKind::ALL.map(Some).into_iter().chain([None]);
    let pairs = views().flat_map(|view| kinds().map(move |kind| (view, kind)));
    pairs.map(|(view, kind)| batch_row(row, warnings, kernel, cell, view, kind)).collect()
}

fn batch_row(
    row: &Row,
    warnings: &[Warning],
    kernel: &KernelChecks,
    cell: &CellSamples,
    view: Option<usize>,
    kind: Option<RayKind>,
) -> Row {
    let matches =
        |check: &&Check| view.is_none_or(|view| view == check.view) && (kind.is_none() || kind == check.kind);
    let checks: Vec<&Check> = kernel.checks.iter().filter(matches).collect();
    let total = |value: fn(&Check) -> u64| checks.iter().map(|check| value(check)).sum::<u64>();
    let rays = total(|check| check.rays);
    let per_ray = |value: fn(&Check) -> Option<u64>| {
        let sum = checks.iter().map(|check| value(check)).sum::<Option<u64>>()?;
        (rays > 0).then(|| figures(sum as f64 / rays as f64))
    };
    let by_round =
        times(cell, kernel.kernel, view, |found| found.is_some() && (kind.is_none() || kind == found));
    let samples = all_ms(&by_round);
    let frames_by_round =
        if kind.is_none() { times(cell, kernel.kernel, view, |found| found.is_none()) } else { Vec::new() };
    let frames = Summary::of(&all_ms(&frames_by_round));
    let summary = Summary::of(&samples).filter(|_| rays > 0);
    let mut warnings = warnings.to_vec();
    warnings.extend(Warning::of_samples(&samples));
    Row {
        view: view.map_or(ALL.into(), |view| view.to_string()),
        ray_kind: kind.map_or(ALL, RayKind::name).into(),
        rays: Some(rays),
        trace_ms_median: summary.map(|s| figures(s.median)),
        trace_ms_mad: summary.map(|s| figures(s.mad)),
        trace_ms_min: summary.map(|s| figures(s.min)),
        trace_ms_max: summary.map(|s| figures(s.max)),
        mrays_s: summary.map(|s| figures(rays as f64 * 1e-3 / s.median)),
        frame_ms_median: frames.map(|s| figures(s.median)),
        frame_ms_mad: frames.map(|s| figures(s.mad)),
        frame_ms_min: frames.map(|s| figures(s.min)),
        frame_ms_max: frames.map(|s| figures(s.max)),
        node_visits_per_ray: per_ray(|check| check.node_visits),
        block_tests_per_ray: per_ray(|check| check.block_tests),
        hits: Some(total(|check| check.hits)),
        hit_hash: if let [check] = checks[..] { check.hash.clone() } else { String::new() },
        ties: Some(total(|check| check.ties)),
        edges: Some(total(|check| check.edge)),
        near_misses: Some(total(|check| check.near_misses)),
        verified: Some(true),
        warnings: Warning::join(&warnings),
        by_round: RowRounds {
            build: row.by_round.build.clone(),
            trace: if rays > 0 { rounded(by_round) } else { Vec::new() },
            frame: rounded(frames_by_round),
        },
        ..row.clone()
    }
}
