//! Lets all contestants follow an animation: in each frame rays are recorded afresh over a reference tree, and every
//! contestant brings its tree up to date and traces them, by turns. Every answer of every frame is verified.

use super::contestant::Contestant;
#[cfg(feature = "embree")]
use super::embree;
use super::entrant::Entrant;
use super::ours::Ours;
use super::records::{FrameRow, SCHEMA};
use crate::bench::cell::Kernel;
use crate::bench::contender::{self, BuiltTree, REFERENCE_KERNEL, TreeUnderKernel};
use crate::bench::environment::moment::utc_now;
use crate::bench::environment::{Machine, Program};
use crate::bench::pools::Pools;
use crate::bench::rays::{self, ViewRays};
use crate::bench::samples::KernelChecks;
use crate::bench::settings::Settings;
use crate::bench::statistics::{figures, median};
use crate::bench::visit::SceneTraces;
use crate::geometry::Mesh;
use crate::scene::{Animation, Scene};
use crate::trace::RayKind;
use std::sync::atomic::AtomicBool;

/// How an animation is followed.
#[derive(Clone, Debug)]
pub struct AnimationSettings {
    /// What takes part.
    pub entrants: Vec<Entrant>,
    /// Frames, evenly from time 0 to 1.
    pub frames: u32,
    /// Updates and traces of each contestant in each frame.
    pub rounds: usize,
    /// Children per node, 4 or 8.
    pub width: u32,
    /// What traces all trees.
    pub kernel: Kernel,
    /// Resolution, views, seed and threads.
    pub trace: Settings,
}

/// A contestant and its figures in the frame at hand.
struct Measured {
    entrant: Entrant,
    row: FrameRow,
    contestant: Option<Box<dyn Contestant>>,
    checks: Option<KernelChecks>,
    /// Its last row was told.
    is_out: bool,
    build_ms: Vec<f64>,
    trace_ms: Vec<f64>,
}

/// Measures all frames of `animation`; `progress` is told the number of each before it begins. A contestant that
/// fails or whose hits are wrong is left out of further frames; its last row says why.
///
/// # Errors
/// No reference tree, or vertices that no mesh can have, in one line.
pub fn measure(
    animation: &Animation,
    settings: &AnimationSettings,
    pools: &Pools,
    progress: &mut dyn FnMut(u32),
) -> Result<Vec<FrameRow>, String> {
    let mut scene = animation.scene.clone();
    let about = FrameRow {
        schema: SCHEMA,
        utc: utc_now(),
        git_rev: Program::this().git_rev,
        cpu: Machine::this("").cpu,
        threads: pools.all.current_num_threads() as u32,
        scene: scene.name.clone(),
        triangles: scene.mesh.len() as u64,
        fixed: animation.fixed as u64,
        frames: settings.frames,
        width: settings.width,
        size: settings.trace.width,
        views: settings.trace.views.min(scene.views.len()) as u32,
        rounds: settings.rounds as u32,
        ..FrameRow::default()
    };
    let mut all: Vec<Measured> =
        settings.entrants.iter().map(|entrant| Measured::new(&about, entrant)).collect();
    let mut rows = Vec::new();
    for frame in 0..settings.frames {
        progress(frame);
        let time = frame as f32 / (settings.frames - 1).max(1) as f32;
        let vertices = pools.all.install(|| animation.vertices(time));
        scene.mesh.move_vertices(&vertices).map_err(|error| format!("frame {frame}: {error}"))?;
        follow(&mut all, &scene, (frame, animation.fixed), settings, pools)?;
        rows.extend(all.iter_mut().filter_map(Measured::finish));
    }
    Ok(rows)
}

/// One frame.
fn follow(
    all: &mut [Measured],
    scene: &Scene,
    (frame, fixed): (u32, usize),
    settings: &AnimationSettings,
    pools: &Pools,
) -> Result<(), String> {
    let (trace, threads) = (&settings.trace, pools.all.current_num_threads());
    let built = contender::reference(&scene.mesh, &pools.all)?;
    let tree = TreeUnderKernel::new(&built, REFERENCE_KERNEL, threads)?;
    let reference = tree.tracer().map_err(str::to_owned)?;
    let recorded = pools.all.install(|| rays::record(reference, scene, trace));
    let count = recorded.iter().map(|view| view.batches.len() as u64).sum();
    let stop = AtomicBool::new(false);
    let mut traces = SceneTraces::new(scene, &recorded, Some(reference), trace, pools, &stop);
    for one in all.iter_mut() {
        one.row = FrameRow { frame, rays: count, ..one.row.clone() };
    }
    for round in 0..settings.rounds {
        for turn in 0..all.len() {
            // Each is first in its turn.
            let one = (turn + round + frame as usize) % all.len();
            let one = &mut all[one];
            // The first frame is a build in every round.
            if frame == 0 && one.row.error.is_empty() {
                match contestant(&one.entrant, settings.width, &scene.mesh, (fixed, threads)) {
                    Ok(contestant) => one.contestant = Some(contestant),
                    Err(error) => one.row.error = error,
                }
            }
            one.visit(scene, (&mut traces, &recorded), (round, settings.kernel), pools);
        }
    }
    Ok(())
}

/// The contestant of `entrant` over trees of `width`, with as many `threads`; the first `fixed` triangles of the
/// mesh never move.
///
/// # Errors
/// No such builder, or none that can follow so.
fn contestant(
    entrant: &Entrant,
    width: u32,
    mesh: &Mesh,
    (fixed, threads): (usize, usize),
) -> Result<Box<dyn Contestant>, String> {
    #[cfg(feature = "embree")]
    if let Some(contestant) = embree::contestant(entrant, width, mesh, threads) {
        return contestant;
    }
    let _ = (mesh, threads);
    Ok(match width {
        8 => Box::new(Ours::<8>::new(entrant, fixed)?),
        _ => Box::new(Ours::<4>::new(entrant, fixed)?),
    })
}

impl Measured {
    fn new(about: &FrameRow, entrant: &Entrant) -> Self {
        let row = FrameRow { builder: entrant.builder.clone(), update: entrant.update, ..about.clone() };
        Self {
            entrant: entrant.clone(),
            row,
            contestant: None,
            checks: None,
            is_out: false,
            build_ms: Vec::new(),
            trace_ms: Vec::new(),
        }
    }

    /// Updates and traces once; what goes wrong is noted.
    fn visit(
        &mut self,
        scene: &Scene,
        (traces, recorded): (&mut SceneTraces<'_>, &[ViewRays]),
        (round, kernel): (usize, Kernel),
        pools: &Pools,
    ) {
        let Some(mut contestant) = self.contestant.take() else { return };
        let visited = contestant.update(&scene.mesh, &pools.all).and_then(|duration| {
            self.build_ms.push(1e3 * duration.as_secs_f64());
            contestant
                .show(&scene.mesh, &mut |built| self.trace(built, (traces, recorded), (round, kernel), pools))
        });
        match visited {
            Ok(()) => self.contestant = Some(contestant),
            Err(error) => self.row.error = error,
        }
    }

    /// Traces all rays, at first to compare every answer with the reference's.
    fn trace(
        &mut self,
        built: &BuiltTree<'_>,
        (traces, recorded): (&mut SceneTraces<'_>, &[ViewRays]),
        (round, kernel): (usize, Kernel),
        pools: &Pools,
    ) -> Result<(), String> {
        let threads = pools.all.current_num_threads();
        let mut tree = TreeUnderKernel::new(built, kernel, threads)?;
        // Without the feature `graft`, and with another version of Embree, each side has its own kernel alone.
        for own in [Kernel::EmbreeNative, Kernel::Phr] {
            if tree.tracer().is_err() {
                tree = TreeUnderKernel::new(built, own, threads)?;
            }
        }
        let tracer = tree.tracer().map_err(str::to_owned)?;
        if self.checks.is_none() {
            self.row.kernel = tree.kernel.name().into();
            self.row.sah = built.tree().ok().map(|tree| figures(tree.sah_cost()));
            self.row.steps = steps(built, recorded, pools);
            self.checks = Some(traces.check(&tree).map_err(|_| "stopped")?);
        }
        let Some(checks) = &mut self.checks else { return Err("not checked".into()) };
        if checks.mismatch.is_none() {
            let timings = traces.time(tracer, round, checks).map_err(|_| "stopped")?;
            self.trace_ms.push(timings.iter().map(|timing| timing.ms).sum());
        }
        match &checks.mismatch {
            Some(wrong) => Err(format!("wrong hits: {wrong}")),
            None => Ok(()),
        }
    }

    /// The row of the frame; none after one that failed.
    fn finish(&mut self) -> Option<FrameRow> {
        let row = &mut self.row;
        let checks = self.checks.take();
        let (builds, traces) = (std::mem::take(&mut self.build_ms), std::mem::take(&mut self.trace_ms));
        if row.error.is_empty() {
            row.verified =
                checks.is_some_and(|checks| checks.mismatch.is_none() && !checks.checks.is_empty());
            row.build_ms = median(&builds).map(figures);
            row.trace_ms = median(&traces).map(figures);
            return Some(row.clone());
        }
        row.verified = false;
        (row.build_ms, row.trace_ms, row.sah, row.steps) = (None, None, None, None);
        (!std::mem::replace(&mut self.is_out, true)).then(|| row.clone())
    }
}

/// Steps of a ray through the tree under our kernel, on average; `None` where Embree's tree cannot be read.
fn steps(built: &BuiltTree<'_>, recorded: &[ViewRays], pools: &Pools) -> Option<f64> {
    let tree = TreeUnderKernel::new(built, Kernel::Phr, pools.all.current_num_threads()).ok()?;
    let (mut steps, mut rays) = (0, 0);
    for (view, kind) in recorded.iter().flat_map(|view| RayKind::ALL.map(|kind| (view, kind))) {
        let batch = view.batches.get(kind);
        let counts = pools.all.install(|| tree.count(kind, batch))?;
        steps += counts.node_visits + counts.block_tests;
        rays += batch.len() as u64;
    }
    (rays > 0).then(|| figures(steps as f64 / rays as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders;
    use crate::scene::animated_by_name;
    use rayon::ThreadPool;
    use std::time::Duration;

    /// Keeps the tree of the mesh as it once was.
    struct Idle(Mesh);

    impl Contestant for Idle {
        fn update(&mut self, _: &Mesh, _: &ThreadPool) -> Result<Duration, String> {
            Ok(Duration::from_millis(1))
        }

        fn show(
            &mut self,
            mesh: &Mesh,
            see: &mut dyn FnMut(&BuiltTree<'_>) -> Result<(), String>,
        ) -> Result<(), String> {
            let tree = builders::by_name::<4>("lbvh").unwrap().build(&self.0).tree;
            see(&BuiltTree::of(mesh, Ok(tree.into()), None))
        }
    }

    #[test]
    fn a_tree_that_answers_wrongly_fails_in_its_frame_and_is_left_out() {
        let animation = animated_by_name("burst").unwrap().generate(2000);
        let (entrants, kernel, trace) = (Vec::new(), Kernel::Phr, Settings::new(16, 1, 1, 2));
        let settings = AnimationSettings { entrants, frames: 3, rounds: 2, width: 4, kernel, trace };
        let pools = Pools::new(&settings.trace).unwrap();
        let entrant = Entrant { builder: "lbvh".into(), ..Entrant::default() };
        let mut all = [0, 1].map(|_| Measured::new(&FrameRow::default(), &entrant));
        let (mut scene, mut rows) = (animation.scene.clone(), Vec::new());
        all[0].contestant = Some(contestant(&entrant, 4, &scene.mesh, (animation.fixed, 2)).unwrap());
        all[1].contestant = Some(Box::new(Idle(scene.mesh.clone())));
        for frame in 1..settings.frames {
            scene.mesh.move_vertices(&animation.vertices(0.5 * frame as f32)).unwrap();
            follow(&mut all, &scene, (frame, animation.fixed), &settings, &pools).unwrap();
            rows.extend(all.iter_mut().filter_map(Measured::finish));
        }
        let told: Vec<(u32, bool)> = rows.iter().map(|row| (row.frame, row.verified)).collect();
        assert_eq!(told, [(1, true), (1, false), (2, true)]);
        assert!(rows[1].error.starts_with("wrong hits: ") && rows[1].trace_ms.is_none(), "{:?}", rows[1]);
    }
}
