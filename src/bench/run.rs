//! A whole run: scene by scene, rounds in random order within a scene, records kept on disk after every
//! visit so that neither Ctrl-C nor a kill loses a finished one.

use super::cell::{Cell, is_saved};
use super::contender::{REFERENCE_KERNEL, TreeUnderKernel};
use super::error::RunError;
use super::plan::Plan;
use super::planned_scene::PlannedScene;
use super::pools::Pools;
use super::precision::widest;
use super::recorder::{RecordOptions, Recorder};
use super::row::Row;
use super::samples::SceneSamples;
use super::visit::{Bench, SceneTraces, Turn};
use super::{contender, memory, rays, rows};
use crate::geometry::Tracer;
use crate::random::SplitMix64;
use crate::scene::Scene;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Receives the progress of a run.
pub trait Progress {
    /// Work in all, in arbitrary units.
    fn begin(&mut self, total: u64);
    /// The current step.
    fn at(&mut self, doing: &str);
    /// Units done since the last call.
    fn advance(&mut self, units: u64);
    /// A remark for the user.
    fn note(&mut self, text: &str);
    /// A scene is done, with these rows.
    fn scene(&mut self, rows: &[Row]);
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// True if all rounds are done.
    pub complete: bool,
    /// Cells whose builder failed or whose hits are wrong.
    pub failures: usize,
    /// All rows.
    pub rows: Vec<Row>,
}

/// A run about to be made.
pub struct Run<'a> {
    /// The scenes and cells to run.
    pub plan: &'a Plan,
    /// How it is recorded.
    pub records: RecordOptions<'a>,
    /// This program, started again to measure the bytes of builds; without it they are not.
    pub program: Option<&'a Path>,
    /// Set when the run is to stop.
    pub stop: &'a AtomicBool,
}

impl Run<'_> {
    /// Visits all cells in all rounds and records the samples.
    ///
    /// # Errors
    /// Those of [`RunError`]; finished visits stay on disk, marked as part of a run.
    pub fn make(&self, progress: &mut dyn Progress) -> Result<Outcome, RunError> {
        let threads = self.plan.settings.threads;
        let pools = Pools::new(&self.plan.settings)
            .map_err(|error| RunError::Threads { threads, reason: error.to_string() })?;
        let mut recorder = Recorder::open(self.plan, &self.records)?;
        let visits = |cells: &[Cell]| cells.len() as u64 * self.plan.settings.rounds as u64;
        progress.begin(self.plan.scenes.iter().map(|(scene, cells)| weight(scene) * visits(cells)).sum());
        let mut ended = Ok(());
        for (scene, cells) in &self.plan.scenes {
            let is_done =
                |samples: &SceneSamples| !self.wants(samples, cells, samples.finished_rounds(cells));
            if recorder.samples.scene(&scene.name).is_some_and(is_done) {
                progress.advance(weight(scene) * visits(cells));
                continue;
            }
            ended = self.scene(scene, cells, &pools, &mut recorder, progress);
            if ended.is_err() || self.stopped() {
                break;
            }
        }
        let complete = ended.is_ok() && !self.stopped();
        let imprecise = recorder.samples.scenes.iter().filter_map(|scene| self.imprecise(scene)).collect();
        recorder.close(complete, imprecise)?;
        ended?;
        let failures =
            recorder.samples.scenes.iter().flat_map(|s| &s.cells).filter(|cell| cell.failed()).count();
        Ok(Outcome { complete, failures, rows: recorder.rows() })
    }

    /// True if `round` is to be run in a scene that was begun.
    fn wants(&self, samples: &SceneSamples, cells: &[Cell], round: usize) -> bool {
        let Plan { settings, all_scenes, .. } = self.plan;
        // Failed cells take no time, so that without others none would ever pass.
        (round < settings.rounds || samples.can_visit(cells))
            && settings.wants(round, samples.spent, all_scenes.len(), || widest(samples))
    }

    /// What is to be told of a scene whose intervals are not as narrow as was asked for.
    fn imprecise(&self, scene: &SceneSamples) -> Option<String> {
        let width = widest(scene);
        let told = || {
            // Of two rounds the interval may be of any width.
            let within = match width < 1.0 {
                true => format!("within ±{:.1} %", 100.0 * width),
                false => "wider than ±100 %".to_owned(),
            };
            format!("{}: intervals {within} after {:.0} s", scene.name, scene.spent)
        };
        self.plan.settings.is_wide(self.plan.all_scenes.len(), || width).then(told)
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn scene(
        &self,
        planned: &PlannedScene,
        cells: &[Cell],
        pools: &Pools,
        recorder: &mut Recorder<'_>,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let settings = &self.plan.settings;
        progress.at(&format!("{}: loading", planned.name));
        let scene = planned.load()?;
        scene.remarks().iter().for_each(|remark| progress.note(remark));
        if settings.build_only {
            return self.rounds(
                &Measured { planned, cells, scene: &scene, reference: None },
                pools,
                recorder,
                progress,
            );
        }
        progress.at(&format!("{}: reference tree", planned.name));
        let no_reference = |reason| RunError::Reference { scene: planned.name.clone(), reason };
        let built = contender::reference(&scene.mesh, &pools.all).map_err(no_reference)?;
        let tree = TreeUnderKernel::new(&built, REFERENCE_KERNEL, settings.threads).map_err(no_reference)?;
        let reference = Some(tree.tracer().map_err(|reason| no_reference(reason.to_owned()))?);
        self.rounds(&Measured { planned, cells, scene: &scene, reference }, pools, recorder, progress)
    }

    fn rounds(
        &self,
        measured: &Measured<'_>,
        pools: &Pools,
        recorder: &mut Recorder<'_>,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let settings = &self.plan.settings;
        let Measured { planned, cells, scene, reference } = *measured;
        let mut rays = Vec::new();
        if let Some(tracer) = reference {
            progress.at(&format!("{}: recording rays", planned.name));
            rays = pools.all.install(|| rays::record(tracer, scene, settings));
        }
        let invalid = rays.iter().map(|view| view.invalid as u64).sum();
        let index = recorder.scene(planned, scene, cells, rays.len(), invalid)?;
        let mut bench = Bench::new(SceneTraces::new(scene, &rays, reference, settings, pools, self.stop));
        let before = recorder.samples.scenes[index].spent;
        let start = Instant::now();
        for round in 0.. {
            if !self.wants(&recorder.samples.scenes[index], cells, round) {
                break;
            }
            for (place, cell) in order(cells, &planned.name, settings.seed, round).into_iter().enumerate() {
                if self.stopped() {
                    return Ok(());
                }
                let samples = recorder.cell(index, cell);
                if samples.error.is_none() && !samples.visits.iter().any(|visit| visit.round == round) {
                    let (name, builder, width) = (&planned.name, &cell.builder, cell.width);
                    progress.at(&format!("{name}: {builder}/{width}, round {}", round + 1));
                    let is_built = !is_saved(&cell.builder);
                    if let Some(program) = self.program.filter(|_| is_built && samples.visits.is_empty()) {
                        match memory::measure(program, &scene.mesh, cell, settings.threads) {
                            Ok(memory) => samples.memory = Some(memory),
                            Err(reason) => {
                                progress.note(&format!("{name}: {builder}/{width}: no bytes: {reason}"))
                            }
                        }
                    }
                    if bench.visit(cell, Turn { round, place }, samples).is_err() {
                        return Ok(());
                    }
                    recorder.samples.scenes[index].spent = before + start.elapsed().as_secs_f64();
                    recorder.save()?;
                }
                if round < settings.rounds {
                    progress.advance(weight(planned));
                }
            }
        }
        self.imprecise(&recorder.samples.scenes[index]).iter().for_each(|note| progress.note(note));
        progress.scene(&rows::scene_rows(&recorder.samples.scenes[index], &recorder.header()));
        Ok(())
    }
}

/// A scene under measurement.
struct Measured<'a> {
    planned: &'a PlannedScene,
    cells: &'a [Cell],
    scene: &'a Scene,
    reference: Option<&'a dyn Tracer>,
}

/// The cells in the order of `round`: the seed, the scene and the round decide.
fn order<'a>(cells: &'a [Cell], scene: &str, seed: u64, round: usize) -> Vec<&'a Cell> {
    let mut order: Vec<&Cell> = cells.iter().collect();
    let scene = scene.bytes().fold(seed, |hash, byte| hash.wrapping_mul(31).wrapping_add(u64::from(byte)));
    SplitMix64::new(scene ^ (round as u64) << 48).shuffle(&mut order);
    order
}

/// Weight of a visit on the progress bar: triangles to build, and some rays.
fn weight(scene: &PlannedScene) -> u64 {
    scene.triangles as u64 + 300_000
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_round_has_an_order_of_its_own_that_repeats() {
        let cell = |width| Cell::new("b", width, &[]);
        let cells: Vec<Cell> = (0..12).map(cell).collect();
        let order = |scene: &str, round| {
            super::order(&cells, scene, 1, round).iter().map(|cell| cell.width).collect::<Vec<_>>()
        };
        assert_eq!(order("a", 0), order("a", 0));
        assert_ne!(order("a", 0), order("a", 1));
        assert_ne!(order("a", 0), order("b", 0));
    }
}
