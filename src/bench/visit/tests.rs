//! Visits with tracers that lie and builders that panic.

use super::*;
use crate::bench::cell::Kernel;
use crate::bench::contender::Ours;
use crate::bench::pools::Pools;
use crate::bench::rays;
use crate::bench::settings::Settings;
use crate::builders::{self, Build, Builder};
use crate::bvh::Bvh4;
use crate::geometry::Tracer;
use crate::geometry::{Dropped, Hit, Mesh, Ray};
use crate::scene::Scene;
use crate::trace::{BvhTracer, RayKind};
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering;

/// A hilly sheet seen from above.
fn scene() -> Scene {
    let n = 12u32;
    let height = |x: u32, y: u32| ((x * 7 + y * 13) % 11) as f32 * 0.2;
    let vertices = (0..n * n).map(|i| [(i % n) as f32, (i / n) as f32, height(i % n, i / n)]).collect();
    let corner = |x: u32, y: u32| y * n + x;
    let quads = (0..(n - 1) * (n - 1)).map(|i| (i % (n - 1), i / (n - 1)));
    let triangles = quads.flat_map(|(x, y)| {
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    let (mesh, _) = Mesh::new(vertices, triangles.collect()).unwrap();
    Scene::new("sheet".into(), mesh, Dropped::default(), Vec::new(), "test".into())
}

/// Answers like `honest`, with one wrong hit in each batch while `lies` is set.
struct Liar<'a> {
    honest: &'a dyn Tracer,
    lies: &'a AtomicBool,
}

impl Tracer for Liar<'_> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.honest.closest(rays, hits);
        if self.lies.load(Ordering::Relaxed)
            && let Some(hit) = hits.iter_mut().find(|hit| hit.is_hit())
        {
            hit.t *= 1.01;
        }
    }

    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.honest.any(rays, occluded);
    }
}

/// Runs `test` with a bench over the sheet and the reference's own tree.
fn with_bench(stop: &AtomicBool, test: impl FnOnce(&mut Bench<'_>, &dyn Tracer)) {
    let scene = scene();
    let built = builders::by_name::<4>("lbvh").unwrap().build(&scene.mesh);
    let tracer = BvhTracer::new(&built.tree);
    let settings = Settings { max_depth: 4, frames: true, ..Settings::new(16, 1, 1, 1) };
    let pools = Pools::new(&settings).unwrap();
    let recorded = pools.all.install(|| rays::record(&tracer, &scene, &settings));
    let mut bench = Bench::new(SceneTraces::new(&scene, &recorded, Some(&tracer), &settings, &pools, stop));
    test(&mut bench, &tracer);
}

/// Traces with `tracer` in `round`; the first verifies.
fn trace(
    bench: &mut Bench<'_>,
    tracer: &dyn Tracer,
    round: usize,
    samples: &mut CellSamples,
) -> Result<(), Stopped> {
    let facts = (round == 0).then(TreeFacts::default);
    let tree = TreeUnderKernel::of_tracer(tracer);
    bench.trace((BuildTimes::default(), facts), vec![tree], Turn { round, place: 0 }, samples)
}

fn cell(builder: &str) -> Cell {
    Cell::new(builder, 4, &[Kernel::Phr])
}

fn samples() -> CellSamples {
    let cell = cell("liar");
    CellSamples {
        cell,
        facts: TreeFacts::default(),
        checks: Vec::new(),
        visits: Vec::new(),
        memory: None,
        error: None,
    }
}

#[test]
fn honest_tracers_are_timed_in_every_batch() {
    with_bench(&AtomicBool::new(false), |bench, honest| {
        let mut samples = samples();
        trace(bench, honest, 0, &mut samples).unwrap();
        trace(bench, honest, 1, &mut samples).unwrap();
        assert!(!samples.failed());
        assert_eq!(samples.checks[0].checks.len(), RayKind::ALL.len());
        assert!(samples.checks[0].checks.iter().all(|check| check.equal == check.rays));
        // Three batches in each pass, and one frame.
        let timings = samples.visits.iter().map(|visit| visit.timings.len());
        assert_eq!(timings.collect::<Vec<_>>(), [3 * PASSES + 1; 2]);
    });
}

#[test]
fn a_wrong_hit_is_found_at_first_and_in_later_rounds() {
    with_bench(&AtomicBool::new(false), |bench, honest| {
        let lies = AtomicBool::new(true);
        let liar = Liar { honest, lies: &lies };
        let mut at_first = samples();
        trace(bench, &liar, 0, &mut at_first).unwrap();
        assert!(at_first.checks[0].mismatch.as_ref().is_some_and(|why| why.contains("1 of")));
        assert!(at_first.failed() && at_first.visits[0].timings.is_empty());

        lies.store(false, Ordering::Relaxed);
        let mut later = samples();
        trace(bench, &liar, 0, &mut later).unwrap();
        assert!(!later.failed());
        lies.store(true, Ordering::Relaxed);
        trace(bench, &liar, 1, &mut later).unwrap();
        assert!(later.checks[0].mismatch.as_ref().is_some_and(|why| why.contains("later round")));
    });
}

#[test]
fn a_tracer_that_does_nothing_is_found_out() {
    struct Idle;
    impl Tracer for Idle {
        fn closest(&self, _: &[Ray], _: &mut [Hit]) {}
        fn any(&self, _: &[Ray], _: &mut [bool]) {}
    }
    with_bench(&AtomicBool::new(false), |bench, _| {
        let mut samples = samples();
        trace(bench, &Idle, 0, &mut samples).unwrap();
        assert!(samples.failed());
    });
}

#[test]
fn a_stopped_visit_leaves_no_samples() {
    with_bench(&AtomicBool::new(true), |bench, honest| {
        let mut samples = samples();
        assert_eq!(trace(bench, honest, 0, &mut samples), Err(Stopped));
        assert!(samples.visits.is_empty());
    });
}

/// A builder with a bug.
struct Panicking;

impl Builder<4> for Panicking {
    fn name(&self) -> &'static str {
        "panicking"
    }

    fn config(&self) -> serde_json::Value {
        serde_json::Value::Null
    }

    fn build(&mut self, _: &Mesh) -> Build<4> {
        let (build, ()) = rayon::join(|| panic!("node {} has no parent", 7), || ());
        build
    }

    fn recycle(&mut self, _: Bvh4) {}
}

#[test]
fn a_builder_that_panics_fails_and_the_bench_goes_on() {
    with_bench(&AtomicBool::new(false), |bench, _| {
        let mut failed = samples();
        let mut contender = Contender::Four(Ours::new(|| Box::new(Panicking)));
        let visit = bench.visit_contender(&mut contender, &cell("panicking"), Turn::default(), &mut failed);
        let reason = "the builder panicked: node 7 has no parent";
        assert_eq!(visit, Err(Unfinished::Failed(reason.into())));
        assert!(failed.visits.is_empty());

        let mut good = samples();
        bench.visit(&cell("lbvh"), Turn::default(), &mut good).unwrap();
        assert!(!good.failed() && good.visits.len() == 1 && good.facts.sah.is_some());
    });
}

#[test]
fn a_cell_without_a_builder_leaves_its_reason() {
    with_bench(&AtomicBool::new(false), |bench, _| {
        let mut samples = samples();
        assert_eq!(bench.visit(&cell("bvh"), Turn::default(), &mut samples), Ok(()));
        assert!(samples.error.is_some_and(|why| why.contains("no builder is called bvh")));
    });
}
