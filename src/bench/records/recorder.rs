//! The records of a run on disk, brought up to date after every visit.

#![allow(
    clippy::indexing_slicing,
    clippy::unreachable,
    reason = "its own records, which it made or compared; it reads none"
)]

use super::environment::moment::Moment;
use super::environment::{ENVIRONMENT, Environment, Machine, Program, State};
use super::files::{Written, hold, new_folder, read_json, write_json};
use super::phases::{self, PHASES};
use super::results_dir::remove_made_of_rows;
use super::rounds::ROUNDS;
use super::row::{self, ROWS, Row, SCHEMA};
use super::rows::{self, Header};
use super::samples::{CellSamples, NO_RESUME, SAMPLES, Samples, SceneSamples};
use super::tree_facts::TreeFacts;
use super::warnings::Warning;
use crate::bench::cell::Cell;
use crate::bench::contender;
use crate::bench::error::RunError;
use crate::bench::plan::Plan;
use crate::bench::planned_scene::PlannedScene;
use crate::random::SplitMix64;
use crate::scene::Scene;
use std::fs::File;
use std::path::Path;

/// Where and how a run is recorded.
pub struct RecordOptions<'a> {
    /// The results folder.
    pub folder: &'a Path,
    /// Go on with the run recorded there.
    pub resume: bool,
    /// Put this run in the place of one recorded there.
    pub replace: bool,
    /// Name of the machine.
    pub host: &'a str,
    /// The command line after the program's name.
    pub arguments: Vec<String>,
}

/// True if a folder holds a run's results: hours of measuring, maybe.
pub fn is_taken(folder: &Path) -> bool {
    [ROWS, SAMPLES].iter().any(|file| folder.join(file).exists())
}

/// The records on disk.
pub struct Recorder<'a> {
    folder: &'a Path,
    /// Keeps other runs out.
    _held: Option<File>,
    /// All samples so far.
    pub samples: Samples,
    environment: Environment,
    /// Whether scenes that are not planned now were left unfinished by a run that this one goes on with.
    others_unfinished: bool,
    rounds: usize,
    threads: usize,
}

impl<'a> Recorder<'a> {
    /// Starts the records, or continues those of the run in the folder.
    pub fn open(plan: &Plan, options: &RecordOptions<'a>) -> Result<Self, RunError> {
        let settings = &plan.settings;
        let folder = options.folder;
        if !options.resume && !options.replace && is_taken(folder) {
            return Err(RunError::Taken(folder.to_owned()));
        }
        new_folder(folder)?;
        let held = hold(folder).map_err(|_| RunError::Held(folder.to_owned()))?;
        let mut recorded_plan = serde_json::json!({
            "settings": settings,
            "scenes": plan.scenes.iter().map(|(scene, _)| &scene.name).collect::<Vec<_>>(),
        });
        if let Some(shard) = plan.shard {
            recorded_plan["shard"] = shard.to_string().into();
            recorded_plan["all_scenes"] = plan.all_scenes.clone().into();
            recorded_plan["all_cells"] = serde_json::json!(plan.all_cells);
            recorded_plan["filter"] = plan.filter.clone().into();
        }
        let machine = Machine::this(options.host);
        let mut environment = Environment {
            schema: SCHEMA,
            run_id: run_id(),
            state: State::Running,
            arguments: options.arguments.clone(),
            plan: recorded_plan,
            program: Program::this(),
            library: contender::library(),
            isa: contender::isa(),
            before: Vec::new(),
            after: None,
            notes: Vec::new(),
            written: None,
            machine,
        };
        let mut others_unfinished = false;
        let mut samples = Samples { schema: SCHEMA, run_id: environment.run_id.clone(), scenes: Vec::new() };
        if options.resume {
            let old: Environment = read_json(&folder.join(ENVIRONMENT), NO_RESUME)?;
            same(&old, &environment, folder)?;
            samples = Samples::read(folder)?;
            if samples.run_id != old.run_id {
                // A kill can fall between the first files of a new run and the removal of the last one's.
                let what = format!("run than {SAMPLES}");
                return Err(RunError::Resume { folder: folder.to_owned(), what });
            }
            // Before anything is written: a refusal leaves the run as it is.
            if let Some(what) = plan.scenes.iter().find_map(|(scene, cells)| samples.differ(scene, cells)) {
                return Err(RunError::Resume { folder: folder.to_owned(), what });
            }
            others_unfinished = old.state != State::Complete && keep_scenes(&mut environment.plan, &old.plan);
            environment.run_id = old.run_id;
            environment.before = old.before;
            environment.notes = old.notes;
        }
        environment.before.push(Moment::now(settings.threads));
        let recorder = Self {
            folder,
            _held: held,
            samples,
            environment,
            others_unfinished,
            rounds: settings.rounds,
            threads: settings.threads,
        };
        recorder.write_environment()?;
        if !options.resume {
            remove_made_of_rows(folder, &[ROWS, ROUNDS, PHASES, SAMPLES])?;
        }
        Ok(recorder)
    }

    /// The scene's index among the samples; adds the scene and its cells where they are new.
    pub fn scene(
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
                remarks: scene.remarks(),
                views,
                invalid_rays,
                spent: 0.0,
                cells: Vec::new(),
            });
        }
        let samples = &mut self.samples.scenes[index];
        // The file may have changed since the run was opened.
        if samples.sha != scene.sha {
            let what = format!("geometry of {}", planned.name);
            return Err(RunError::Resume { folder: self.folder.to_owned(), what });
        }
        for cell in cells {
            if !samples.cells.iter().any(|known| known.cell == *cell) {
                samples.cells.push(CellSamples {
                    cell: cell.clone(),
                    facts: TreeFacts::default(),
                    checks: Vec::new(),
                    visits: Vec::new(),
                    memory: None,
                    error: None,
                });
            }
        }
        samples.cells.sort_by(|a, b| a.cell.order().cmp(&b.cell.order()));
        Ok(index)
    }

    /// The samples of a cell that [`Recorder::scene`] has entered.
    pub fn cell(&mut self, scene: usize, cell: &Cell) -> &mut CellSamples {
        let cells = &mut self.samples.scenes[scene].cells;
        match cells.iter().position(|known| known.cell == *cell) {
            Some(index) => &mut cells[index],
            None => unreachable!("a scene's cells are entered before its first visit"),
        }
    }

    /// The columns that all rows share.
    pub fn header(&self) -> Header {
        let mut warnings = Vec::new();
        if self.threads > self.environment.machine.processors {
            warnings.push(Warning::ThreadMismatch);
        }
        let mut moments = self.environment.before.iter().chain(&self.environment.after);
        if moments.any(|moment| moment.busy().is_some()) {
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

    /// All rows so far.
    pub fn rows(&self) -> Vec<Row> {
        rows::rows(&self.samples, &self.header())
    }

    /// Brings samples and rows on disk up to date.
    pub fn save(&self) -> Result<Written, RunError> {
        self.samples.write(self.folder)?;
        phases::write(self.folder, &phases::of_samples(&self.samples))?;
        Ok(row::write_all(self.folder, &self.rows())?)
    }

    fn write_environment(&self) -> Result<(), RunError> {
        write_json(&self.folder.join(ENVIRONMENT), &self.environment)?;
        Ok(())
    }

    /// Writes how the run ended, with a line for each of its scenes that is `imprecise`.
    pub fn close(&mut self, complete: bool, imprecise: Vec<String>) -> Result<(), RunError> {
        let complete = complete && !self.others_unfinished;
        self.environment.state = if complete { State::Complete } else { State::Interrupted };
        self.environment.after = Some(Moment::now(self.threads));
        let mut notes = Vec::new();
        for scene in &self.samples.scenes {
            notes.extend(scene.remarks.iter().cloned());
            if scene.invalid_rays > 0 {
                let count = scene.invalid_rays;
                notes.push(format!("{}: {count} rays left out that Embree would not accept", scene.name));
            }
        }
        notes.extend(imprecise);
        self.environment.notes = notes;
        if !self.samples.scenes.is_empty() {
            self.environment.written = Some(self.save()?);
        }
        self.write_environment()
    }
}

/// Adds the scenes of the plan `old` that `new` lacks; returns whether there are any.
fn keep_scenes(new: &mut serde_json::Value, old: &serde_json::Value) -> bool {
    let of = |plan: &serde_json::Value| plan["scenes"].as_array().cloned().unwrap_or_default();
    let mut scenes = of(new);
    let planned = scenes.len();
    scenes.extend(of(old).into_iter().filter(|scene| !of(new).contains(scene)));
    let kept = scenes.len() > planned;
    new["scenes"] = scenes.into();
    kept
}

/// Refuses to mix samples of different programs, machines or settings; the number of rounds and the time may be others.
fn same(old: &Environment, new: &Environment, folder: &Path) -> Result<(), RunError> {
    let differs = |what: String| Err(RunError::Resume { folder: folder.to_owned(), what });
    if old.program != new.program {
        return differs(format!("build of this program ({})", old.program.git_rev));
    }
    if old.library != new.library {
        return differs(format!("Embree ({})", old.library.embree));
    }
    if !old.is_alike(new) {
        return differs(format!("processor, number of processors or instruction set ({})", old.machine.cpu));
    }
    let settings = |environment: &Environment| environment.plan["settings"].as_object().cloned();
    let (old, new) = (settings(old).unwrap_or_default(), settings(new).unwrap_or_default());
    let must_agree = |key: &str| !matches!(key, "rounds" | "seconds" | "until_permille" | "limit");
    match new.iter().find(|(key, value)| must_agree(key) && old.get(*key) != Some(value)) {
        Some((key, _)) => {
            let option = if matches!(&**key, "width" | "height") { "size" } else { key };
            differs(format!("value of {option} ({})", old.get(key).unwrap_or(&serde_json::Value::Null)))
        }
        None => Ok(()),
    }
}

/// Twelve hexadecimal digits, from the time and the process.
fn run_id() -> String {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let nanoseconds = now.map_or(0, |duration| duration.as_nanos() as u64);
    let bits = SplitMix64::new(nanoseconds ^ u64::from(std::process::id()) << 32).next_u64();
    format!("{:012x}", bits >> 16)
}
