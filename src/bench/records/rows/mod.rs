//! The rows that the samples give: medians, spreads and warnings.

mod build_rows;
mod kernel_rows;

use crate::bench::row::{ALL, FRESH, NO_KERNEL, Row, SCHEMA, UNAVAILABLE};
use crate::bench::samples::{CellSamples, Samples, SceneSamples};
use crate::bench::statistics::figures;
use crate::bench::warnings::Warning;
use build_rows::BuildRows;
use kernel_rows::kernel_rows;

/// The columns that all rows of a run share.
#[derive(Clone, Debug, Default)]
pub struct Header {
    /// Names the run.
    pub run_id: String,
    /// Start of the run.
    pub utc: String,
    /// Name given to the machine.
    pub host: String,
    /// Revision of this program.
    pub git_rev: String,
    /// Threads of each side.
    pub threads: usize,
    /// Rounds asked for.
    pub rounds: usize,
    /// Warnings that concern the whole run.
    pub warnings: Vec<Warning>,
}

/// The rows of all samples.
pub fn rows(samples: &Samples, header: &Header) -> Vec<Row> {
    samples.scenes.iter().flat_map(|scene| scene_rows(scene, header)).collect()
}

/// The rows of one scene.
pub fn scene_rows(scene: &SceneSamples, header: &Header) -> Vec<Row> {
    let begun = scene.cells.iter().filter(|cell| cell.error.is_some() || !cell.visits.is_empty());
    begun.flat_map(|cell| cell_rows(scene, cell, header)).collect()
}

fn cell_rows(scene: &SceneSamples, cell: &CellSamples, header: &Header) -> Vec<Row> {
    let facts = &cell.facts;
    let base = Row {
        schema: SCHEMA,
        run_id: header.run_id.clone(),
        utc: header.utc.clone(),
        host: header.host.clone(),
        git_rev: header.git_rev.clone(),
        scene: scene.name.clone(),
        scene_sha: scene.sha.clone(),
        triangles: scene.triangles,
        builder: cell.cell.builder.clone(),
        builder_config: facts.config.clone(),
        engine: facts.engine.clone(),
        width: cell.cell.width,
        threads: header.threads as u32,
        regime: FRESH.into(),
        rounds: cell.visits.len() as u32,
        view: ALL.into(),
        kernel: NO_KERNEL.into(),
        ray_kind: ALL.into(),
        ..Row::default()
    };
    if let Some(error) = &cell.error {
        let warnings = Warning::join(&header.warnings);
        return vec![Row { error: error.clone(), warnings, ..base }];
    }
    let known = Row {
        sah: facts.sah.map(figures),
        epo: facts.epo.map(figures),
        nodes: facts.nodes,
        leaves: facts.leaves,
        leaf_fill: facts.leaf_fill.map(figures),
        refs_per_tri: facts.refs_per_tri.map(figures),
        bytes: cell.memory.map(|memory| memory.live_bytes),
        peak_bytes: cell.memory.map(|memory| memory.peak_bytes),
        ..base
    };

    let of_run = |samples: &[f64]| {
        let mut warnings = header.warnings.clone();
        warnings.extend(Warning::of_samples(samples));
        if cell.visits.len() < header.rounds {
            warnings.push(Warning::Unfinished);
        }
        warnings
    };
    let BuildRows { compared, mut warnings, others: mut rows } = BuildRows::of(cell, known, of_run);
    if cell.checks.is_empty() {
        rows.push(compared);
        return rows;
    }
    let load = cell.visits.iter().map(|visit| visit.cpu_time).sum();
    warnings.extend(Warning::of_cpu_time(&load, header.threads));
    for kernel in &cell.checks {
        let row = Row { kernel: kernel.kernel.name().into(), isa: kernel.isa.clone(), ..compared.clone() };
        if let Some(reason) = &kernel.unavailable {
            rows.push(Row { error: format!("{UNAVAILABLE}, because {reason}"), ..row });
        } else if let Some(mismatch) = &kernel.mismatch {
            rows.push(Row { verified: Some(false), error: mismatch.clone(), ..row });
        } else {
            rows.extend(kernel_rows(&row, &warnings, kernel, cell, scene.views));
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::build_times::{BuildTimes, WarmTimes};
    use crate::bench::cell::{Cell, Kernel};
    use crate::bench::cpu_time::CpuTime;
    use crate::bench::memory::BuildMemory;
    use crate::bench::rounds::RowRounds;
    use crate::bench::row::{FIRST, REBUILD};
    use crate::bench::samples::{Check, KernelChecks, Timing, VisitSamples};
    use crate::bench::tree_facts::TreeFacts;
    use crate::geometry::Dropped;
    use crate::trace::RayKind;

    fn warm(ms: [f64; 3]) -> WarmTimes {
        WarmTimes { ms: ms.into(), ..WarmTimes::default() }
    }

    /// Two views, shadow rays in the first only, three rounds of three passes, one of which is disturbed; primary
    /// rays take 1 ms a view, shadow 2 ms.
    fn scene() -> SceneSamples {
        let check = |view, kind, rays| Check {
            view,
            kind: Some(kind),
            rays,
            hits: rays / 2,
            hash: format!("{view}{rays}"),
            node_visits: Some(10 * rays),
            block_tests: None,
            ..Check::default()
        };
        let checks = KernelChecks {
            kernel: Kernel::Phr,
            isa: "avx2".into(),
            unavailable: None,
            checks: vec![
                check(0, RayKind::Primary, 1000),
                check(0, RayKind::Shadow, 500),
                check(1, RayKind::Primary, 1000),
            ],
            mismatch: None,
        };
        let timing = |view, kind, pass, ms| Timing { kernel: Kernel::Phr, view, kind, pass, ms };
        let batches = |(pass, slower): (usize, f64)| {
            [
                timing(0, Some(RayKind::Primary), pass, slower),
                timing(0, Some(RayKind::Shadow), pass, 2.0 * slower),
                timing(1, Some(RayKind::Primary), pass, slower),
            ]
        };
        let passes = [1.0, 1.0, 7.0].into_iter().enumerate();
        let frames = [timing(0, None, 0, 9.0), timing(1, None, 0, 5.0)];
        let timings: Vec<Timing> = passes.flat_map(batches).chain(frames).collect();
        let visit = |round| VisitSamples {
            round,
            place: 0,
            builds: BuildTimes {
                first_ms: 30.0,
                fresh: warm([10.0, 11.0, 10.0]),
                rebuild: warm([9.0, 8.0, 7.0]),
                ..BuildTimes::default()
            },
            timings: timings.clone(),
            cpu_time: CpuTime::default(),
        };
        let cell = Cell::new("phr-hq", 4, &[Kernel::Phr]);
        let cells = vec![CellSamples {
            cell,
            facts: TreeFacts { sah: Some(12.0), ..TreeFacts::default() },
            checks: vec![checks],
            visits: (0..3).map(visit).collect(),
            memory: Some(BuildMemory { peak_bytes: 9000, live_bytes: 6000 }),
            error: None,
        }];
        SceneSamples {
            name: "s".into(),
            sha: "0".into(),
            source: "test".into(),
            triangles: 1_000_000,
            dropped: Dropped::default(),
            remarks: Vec::new(),
            views: 2,
            invalid_rays: 0,
            spent: 0.0,
            cells,
        }
    }

    fn header() -> Header {
        Header { threads: 2, rounds: 3, ..Header::default() }
    }

    fn find<'a>(rows: &'a [Row], view: &str, kind: &str) -> &'a Row {
        let mut found = rows.iter().filter(|r| r.regime == FRESH && r.view == view && r.ray_kind == kind);
        let row = found.next().unwrap();
        assert!(found.next().is_none(), "{view} {kind} twice");
        row
    }

    #[test]
    fn sums_are_sums_of_their_parts() {
        let rows = scene_rows(&scene(), &header());
        assert_eq!(rows.len(), 2 + 3 * 4);
        let total = find(&rows, ALL, ALL);
        assert_eq!((total.rays, total.trace_ms_median, total.mrays_s), (Some(2500), Some(4.0), Some(0.625)));
        assert_eq!((total.hits, total.frame_ms_median), (Some(1250), Some(14.0)));
        assert_eq!((total.node_visits_per_ray, total.block_tests_per_ray), (Some(10.0), None));
        assert_eq!((total.build_ms_median, total.build_mtri_s), (Some(10.0), Some(100.0)));
        let rounds = |ms: f64| vec![(0, ms), (1, ms), (2, ms)];
        let by_round = RowRounds { build: rounds(10.0), trace: rounds(4.0), frame: rounds(14.0) };
        assert_eq!(total.by_round, by_round);
        let primary = find(&rows, ALL, "primary");
        assert_eq!(
            (primary.rays, primary.trace_ms_median, primary.frame_ms_median),
            (Some(2000), Some(2.0), None)
        );
        let view = find(&rows, "0", ALL);
        assert_eq!(
            (view.rays, view.trace_ms_median, view.frame_ms_median),
            (Some(1500), Some(3.0), Some(9.0))
        );
        assert_eq!(find(&rows, "0", "shadow").hit_hash, "0500");
        let none = find(&rows, "1", "shadow");
        assert_eq!((none.rays, none.mrays_s), (Some(0), None));
        assert!(rows.iter().all(|row| row.is_good() && row.sah == Some(12.0)));
        assert!(rows.iter().all(|row| (row.peak_bytes, row.bytes) == (Some(9000), Some(6000))));
        let of = |regime| rows.iter().find(|row| row.regime == regime).unwrap();
        assert_eq!((of(FIRST).build_ms_median, of(FIRST).kernel.as_str()), (Some(30.0), NO_KERNEL));
        assert_eq!((of(REBUILD).build_ms_median, of(REBUILD).kernel.as_str()), (Some(8.0), NO_KERNEL));
    }

    #[test]
    fn of_static_and_dynamic_rebuilds_the_faster_stand_in_the_row() {
        for (dynamic, expected) in [([20.0, 20.0, 20.0], 8.0), ([6.0, 5.0, 4.0], 5.0)] {
            let mut scene = scene();
            for visit in &mut scene.cells[0].visits {
                visit.builds.dynamic_rebuild = Some(warm(dynamic));
            }
            let rows = scene_rows(&scene, &header());
            let row = rows.iter().find(|row| row.regime == REBUILD).unwrap();
            assert_eq!(row.build_ms_median, Some(expected));
        }
    }

    #[test]
    fn builds_on_one_thread_have_a_row_of_their_own() {
        let mut scene = scene();
        for (visit, ms) in scene.cells[0].visits.iter_mut().zip([19.0, 30.0, 20.0]) {
            visit.builds.one_thread = Some(warm([ms + 1.0, ms, ms - 1.0]));
        }
        let rows = scene_rows(&scene, &header());
        let alone: Vec<&Row> = rows.iter().filter(|row| row.threads == 1).collect();
        let [alone] = alone[..] else { panic!("one row, not {}", alone.len()) };
        assert_eq!((alone.build_ms_median, alone.kernel.as_str()), (Some(20.0), NO_KERNEL));
        assert_eq!((alone.sah, alone.trace_ms_median, alone.regime.as_str()), (Some(12.0), None, FRESH));
        assert_eq!(rows.len(), 1 + scene_rows(&self::scene(), &header()).len());
    }

    #[test]
    fn wrong_hits_and_failed_builders_have_no_figures() {
        let mut wrong = scene();
        wrong.cells[0].checks[0].mismatch = Some("ray 7".into());
        let rows = scene_rows(&wrong, &header());
        let row = rows.iter().find(|row| row.kernel == "phr").unwrap();
        assert!(!row.is_good() && row.mrays_s.is_none() && row.error == "ray 7");
        assert_eq!(rows.iter().filter(|row| row.kernel == "phr").count(), 1);

        let mut failed = scene();
        failed.cells[0].error = Some("not the builder asked for".into());
        let rows = scene_rows(&failed, &header());
        assert_eq!(rows.len(), 1);
        assert!(!rows[0].is_good() && rows[0].build_ms_median.is_none());
    }

    #[test]
    fn missing_rounds_are_named() {
        let rows = scene_rows(&scene(), &Header { rounds: 5, ..header() });
        assert!(rows.iter().all(|row| row.warnings.contains("Unfinished") && row.rounds == 3));
        let rows = scene_rows(&scene(), &header());
        assert!(rows.iter().all(|row| !row.warnings.contains("Unfinished")));
    }
}
