//! A whole run: scene by scene, rounds in random order within a scene, records kept on disk after every
//! visit so that neither Ctrl-C nor a kill loses a finished one.

use super::book::Book;
use super::contender::{Cell, Pools};
use super::measure::Bench;
use super::plan::Plan;
use super::planned_scene::PlannedScene;
use super::random::SplitMix;
use super::records::{RecordsError, Row};
use super::{embree_side, rays, summary};
use crate::geometry::Tracer;
use crate::scene::{Scene, SceneError};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Why a run could not be made or finished.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The results cannot be read or written.
    #[error(transparent)]
    Records(#[from] RecordsError),
    /// A scene cannot be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The reference tree cannot be built.
    #[error("{scene}: no reference hits: {reason}")]
    Reference {
        /// The scene.
        scene: String,
        /// Embree's words.
        reason: String,
    },
    /// The threads cannot be had.
    #[error("--threads {threads}: {reason}; give fewer")]
    Threads {
        /// Threads asked for.
        threads: usize,
        /// What the system says.
        reason: String,
    },
    /// `--resume` with other settings.
    #[error("{}: made with another {what}; give the same, or run without --resume", folder.display())]
    Resume {
        /// The folder.
        folder: PathBuf,
        /// What differs.
        what: String,
    },
}

/// Told of a run's course.
pub trait Progress {
    /// Work in all, in arbitrary units.
    fn begin(&mut self, total: u64);
    /// What is being done.
    fn at(&mut self, doing: &str);
    /// Units done since the last call.
    fn advance(&mut self, units: u64);
    /// Something the user should know.
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
    /// What is run.
    pub plan: &'a Plan,
    /// Where records go.
    pub folder: &'a Path,
    /// Go on from what is there.
    pub resume: bool,
    /// Name of the machine for the records.
    pub host: &'a str,
    /// The command line, for the records.
    pub arguments: Vec<String>,
    /// Set when the run is to stop.
    pub stop: &'a AtomicBool,
}

impl Run<'_> {
    /// Makes the run and writes its records.
    ///
    /// # Errors
    /// Those of [`RunError`]; what was finished before stays on disk, marked as part of a run.
    pub fn make(&self, progress: &mut dyn Progress) -> Result<Outcome, RunError> {
        let threads = self.plan.settings.threads;
        let pools = Pools::new(&self.plan.settings)
            .map_err(|error| RunError::Threads { threads, reason: error.to_string() })?;
        let mut book = Book::open(self)?;
        let visits = |cells: &[Cell]| cells.len() as u64 * self.plan.settings.rounds as u64;
        progress.begin(self.plan.scenes.iter().map(|(scene, cells)| weight(scene) * visits(cells)).sum());
        let mut ended = Ok(());
        for (scene, cells) in &self.plan.scenes {
            if book.samples.scene(&scene.name).is_some_and(|s| s.is_done(cells, self.plan.settings.rounds)) {
                progress.advance(weight(scene) * visits(cells));
                continue;
            }
            ended = self.scene(scene, cells, &pools, &mut book, progress);
            if ended.is_err() || self.stopped() {
                break;
            }
        }
        let complete = ended.is_ok() && !self.stopped();
        book.close(complete)?;
        ended?;
        let failures = book.samples.scenes.iter().flat_map(|s| &s.cells).filter(|cell| cell.failed()).count();
        Ok(Outcome { complete, failures, rows: book.rows() })
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn scene(
        &self,
        planned: &PlannedScene,
        cells: &[Cell],
        pools: &Pools,
        book: &mut Book<'_>,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let settings = &self.plan.settings;
        progress.at(&format!("{}: loading", planned.name));
        let scene = planned.load()?;
        if scene.dropped.total() > 0 {
            progress.note(&format!("{}: {}", scene.name, scene.dropped));
        }
        if settings.build_only {
            return self.rounds(
                &Measured { planned, cells, scene: &scene, reference: None },
                pools,
                book,
                progress,
            );
        }
        progress.at(&format!("{}: reference tree", planned.name));
        let mut done = Ok(());
        embree_side::reference(&scene.mesh, &pools.all, &mut |tracer| {
            let measured = Measured { planned, cells, scene: &scene, reference: Some(tracer) };
            done = self.rounds(&measured, pools, book, progress);
        })
        .map_err(|reason| RunError::Reference { scene: planned.name.clone(), reason })?;
        done
    }

    fn rounds(
        &self,
        measured: &Measured<'_>,
        pools: &Pools,
        book: &mut Book<'_>,
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
        let index = book.scene(planned, scene, cells, rays.len(), invalid)?;
        let mut bench = Bench::new(scene, &rays, reference, settings, pools, self.stop);
        let start = Instant::now();
        for round in (0..).take_while(|&round| settings.wants(round, start.elapsed())) {
            for (place, cell) in order(cells, &planned.name, settings.seed, round).into_iter().enumerate() {
                if self.stopped() {
                    return Ok(());
                }
                let samples = book.cell(index, cell);
                if samples.error.is_none() && !samples.visits.iter().any(|visit| visit.round == round) {
                    let (name, builder, width) = (&planned.name, &cell.builder, cell.width);
                    progress.at(&format!("{name}: {builder}/{width}, round {}", round + 1));
                    if bench.visit(cell, round, place, samples).is_err() {
                        return Ok(());
                    }
                    book.save()?;
                }
                if round < settings.rounds {
                    progress.advance(weight(planned));
                }
            }
        }
        progress.scene(&summary::scene_rows(&book.samples.scenes[index], &book.header()));
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
    SplitMix::new(scene ^ (round as u64) << 48).shuffle(&mut order);
    order
}

/// What a visit weighs on the progress bar: triangles to build, and some rays.
fn weight(scene: &PlannedScene) -> u64 {
    scene.triangles as u64 + 300_000
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_round_has_an_order_of_its_own_that_repeats() {
        let cell = |width| Cell { builder: "b".into(), width, kernels: Vec::new() };
        let cells: Vec<Cell> = (0..12).map(cell).collect();
        let order = |scene: &str, round| {
            super::order(&cells, scene, 1, round).iter().map(|cell| cell.width).collect::<Vec<_>>()
        };
        assert_eq!(order("a", 0), order("a", 0));
        assert_ne!(order("a", 0), order("a", 1));
        assert_ne!(order("a", 0), order("b", 0));
    }
}
