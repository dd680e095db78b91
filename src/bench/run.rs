//! A whole run: scene by scene, rounds in random order within a scene, records kept on disk after every
//! visit so that neither Ctrl-C nor a kill loses a finished one.

use super::contender::{self, Cell};
use super::embree_side;
use super::environment::{ENVIRONMENT, Environment, Machine, Moment, Program, State};
use super::measure::Bench;
use super::plan::{Plan, PlannedScene};
use super::random::SplitMix;
use super::records::{self, ROWS, RecordsError, Row, SCHEMA};
use super::samples::{CellSamples, SAMPLES, Samples, SceneSamples, read_json};
use super::summary::{self, Header};
use super::warnings::Warning;
use super::{contender::Facts, rays};
use crate::geometry::Tracer;
use crate::scene::{Scene, SceneError};
use crate::trace::Isa;
use rayon::ThreadPool;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

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
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|index| format!("phr-{index}"))
            .build()
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
            ended = self.scene(scene, cells, &pool, &mut book, progress);
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
        pool: &ThreadPool,
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
                pool,
                book,
                progress,
            );
        }
        progress.at(&format!("{}: reference tree", planned.name));
        let mut done = Ok(());
        embree_side::reference(&scene.mesh, pool, &mut |tracer| {
            let measured = Measured { planned, cells, scene: &scene, reference: Some(tracer) };
            done = self.rounds(&measured, pool, book, progress);
        })
        .map_err(|reason| RunError::Reference { scene: planned.name.clone(), reason })?;
        done
    }

    fn rounds(
        &self,
        measured: &Measured<'_>,
        pool: &ThreadPool,
        book: &mut Book<'_>,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let settings = &self.plan.settings;
        let Measured { planned, cells, scene, reference } = *measured;
        let mut rays = Vec::new();
        if let Some(tracer) = reference {
            progress.at(&format!("{}: recording rays", planned.name));
            rays = pool.install(|| rays::record(tracer, scene, settings));
        }
        let invalid = rays.iter().map(|view| view.invalid as u64).sum();
        let index = book.scene(planned, scene, cells, rays.len(), invalid)?;
        let mut bench = Bench::new(scene, &rays, reference, settings, pool, self.stop);
        for round in 0..settings.rounds {
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
                progress.advance(weight(planned));
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

/// The records on disk.
struct Book<'a> {
    folder: &'a Path,
    samples: Samples,
    environment: Environment,
    rounds: usize,
    threads: usize,
}

impl<'a> Book<'a> {
    /// Starts the records, or takes up those of a run that was stopped.
    fn open(run: &Run<'a>) -> Result<Self, RunError> {
        let settings = &run.plan.settings;
        let folder = run.folder;
        std::fs::create_dir_all(folder).map_err(|source| RecordsError::Io {
            path: folder.to_owned(),
            source,
            remedy: "give a writable folder with --out",
        })?;
        let plan = serde_json::json!({
            "settings": settings,
            "scenes": run.plan.scenes.iter().map(|(scene, _)| &scene.name).collect::<Vec<_>>(),
        });
        let machine = Machine::this(run.host);
        let mut environment = Environment {
            schema: SCHEMA,
            run_id: run_id(),
            state: State::Running,
            arguments: run.arguments.clone(),
            plan,
            program: Program::this(),
            library: embree_side::library(),
            isa: serde_json::json!({ "phr": Isa::best().name() }),
            before: Vec::new(),
            after: None,
            notes: Vec::new(),
            machine,
        };
        let mut samples = Samples { schema: SCHEMA, run_id: environment.run_id.clone(), scenes: Vec::new() };
        if run.resume {
            let old: Environment = read_json(&folder.join(ENVIRONMENT))?;
            same(&old, &environment, folder)?;
            samples = Samples::read(folder)?;
            environment.run_id = old.run_id;
            environment.before = old.before;
            environment.notes = old.notes;
        }
        environment.before.push(Moment::now(settings.threads));
        let book = Self { folder, samples, environment, rounds: settings.rounds, threads: settings.threads };
        book.write_environment()?;
        if !run.resume {
            // Nothing of an older run may pass for part of this one.
            for file in [ROWS, SAMPLES, "table1.md"] {
                let path = folder.join(file);
                if path.exists() {
                    let remedy = "give another folder with --out";
                    std::fs::remove_file(&path).map_err(|source| RecordsError::Io {
                        path,
                        source,
                        remedy,
                    })?;
                }
            }
        }
        Ok(book)
    }

    /// The scene's place among the samples, with all its cells.
    fn scene(
        &mut self,
        planned: &PlannedScene,
        scene: &Scene,
        cells: &[Cell],
        views: usize,
        invalid_rays: u64,
    ) -> Result<usize, RunError> {
        let known = self.samples.scenes.iter().position(|known| known.name == planned.name);
        let index = known.unwrap_or(self.samples.scenes.len());
        if known.is_none() {
            self.samples.scenes.push(SceneSamples {
                name: planned.name.clone(),
                sha: scene.sha.clone(),
                source: planned.origin(),
                triangles: scene.mesh.len() as u64,
                dropped: scene.dropped,
                views,
                invalid_rays,
                cells: Vec::new(),
            });
        }
        let samples = &mut self.samples.scenes[index];
        if samples.sha != scene.sha {
            let what = format!("geometry of {}", planned.name);
            return Err(RunError::Resume { folder: self.folder.to_owned(), what });
        }
        for cell in cells {
            if !samples.cells.iter().any(|known| known.cell == *cell) {
                samples.cells.push(CellSamples {
                    cell: cell.clone(),
                    facts: Facts::default(),
                    checks: Vec::new(),
                    visits: Vec::new(),
                    error: None,
                });
            }
        }
        samples.cells.sort_by_key(|cell| (contender::place(&cell.cell.builder), cell.cell.width));
        Ok(index)
    }

    fn cell(&mut self, scene: usize, cell: &Cell) -> &mut CellSamples {
        let cells = &mut self.samples.scenes[scene].cells;
        match cells.iter().position(|known| known.cell == *cell) {
            Some(index) => &mut cells[index],
            None => unreachable!("a scene's cells are entered before its first visit"),
        }
    }

    fn header(&self) -> Header {
        let mut warnings = Vec::new();
        if self.threads > self.environment.machine.processors {
            warnings.push(Warning::ThreadMismatch);
        }
        let mut moments = self.environment.before.iter().chain(&self.environment.after);
        if moments.any(|moment| !moment.spin.is_enough()) {
            warnings.push(Warning::Contended);
        }
        Header {
            run_id: self.environment.run_id.clone(),
            utc: self.environment.before.first().map(|moment| moment.utc.clone()).unwrap_or_default(),
            host: self.environment.machine.host.clone(),
            git_rev: self.environment.program.git_rev.clone(),
            threads: self.threads,
            rounds: self.rounds,
            warnings,
        }
    }

    fn rows(&self) -> Vec<Row> {
        summary::rows(&self.samples, &self.header())
    }

    /// Brings samples and rows on disk up to date.
    fn save(&self) -> Result<(), RunError> {
        self.samples.write(self.folder)?;
        records::write(&self.folder.join(ROWS), &self.rows())?;
        Ok(())
    }

    fn write_environment(&self) -> Result<(), RunError> {
        records::write_json(&self.folder.join(ENVIRONMENT), &self.environment)?;
        Ok(())
    }

    fn close(&mut self, complete: bool) -> Result<(), RunError> {
        self.environment.state = if complete { State::Complete } else { State::Interrupted };
        self.environment.after = Some(Moment::now(self.threads));
        let mut notes = Vec::new();
        for scene in &self.samples.scenes {
            if scene.dropped.total() > 0 {
                notes.push(format!("{}: {}", scene.name, scene.dropped));
            }
            if scene.invalid_rays > 0 {
                let count = scene.invalid_rays;
                notes.push(format!("{}: {count} rays left out that Embree would not accept", scene.name));
            }
        }
        self.environment.notes = notes;
        self.environment.isa["embree"] = self.embree_isa().into();
        if !self.samples.scenes.is_empty() {
            self.save()?;
        }
        self.write_environment()
    }

    fn embree_isa(&self) -> Option<String> {
        let cells = self.samples.scenes.iter().flat_map(|scene| &scene.cells);
        let mut kernels = cells.flat_map(|cell| &cell.checks);
        let native = kernels.find(|kernel| kernel.kernel == contender::Kernel::EmbreeNative)?;
        Some(native.isa.clone())
    }
}

/// Refuses to mix samples of different programs or settings; the number of rounds may grow.
fn same(old: &Environment, new: &Environment, folder: &Path) -> Result<(), RunError> {
    let differs = |what: String| Err(RunError::Resume { folder: folder.to_owned(), what });
    if old.program != new.program {
        return differs(format!("build of this program ({})", old.program.git_rev));
    }
    if old.library != new.library {
        return differs(format!("Embree ({})", old.library.embree));
    }
    let settings = |environment: &Environment| environment.plan["settings"].as_object().cloned();
    let (old, new) = (settings(old).unwrap_or_default(), settings(new).unwrap_or_default());
    match new.iter().find(|(key, value)| *key != "rounds" && old.get(*key) != Some(value)) {
        Some((key, _)) => differs(format!("{key} ({})", old.get(key).unwrap_or(&serde_json::Value::Null))),
        None => Ok(()),
    }
}

/// Twelve hexadecimal digits that hardly two runs share.
fn run_id() -> String {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let nanoseconds = now.map_or(0, |duration| duration.as_nanos() as u64);
    let bits = SplitMix::new(nanoseconds ^ u64::from(std::process::id()) << 32).next_u64();
    format!("{:012x}", bits >> 16)
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
