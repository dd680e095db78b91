//! The shards of a run, merged: the rows and rounds that one machine would have written, scenes in the order of the
//! run. Shards of unlike machines are merged apart: their times are not averaged.

use super::environment::{ENVIRONMENT, Environment, State};
use super::files::{RecordsError, new_folder, write_json};
use super::phases::{self, PHASES};
use super::results_dir;
use super::rounds::ROUNDS;
use super::row::{self, ROWS, Row};
use super::samples::SAMPLES;
use std::path::{Path, PathBuf};

/// The folder of shards in that of a run. Two levels above their rows, which no reader of subfolders takes for its own.
pub const SHARDS: &str = "shards";
/// The folder of machines, where they are unlike.
pub const MACHINES: &str = "machines";

/// Why shards could not be merged.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// The records cannot be read or written.
    #[error(transparent)]
    Records(#[from] RecordsError),
    /// There are none.
    #[error("{}: no shards; run `phr bench --shard K/N --out {}` for each K first", .0.display(), .0.display())]
    None(PathBuf),
    /// The records do not say what was to be measured.
    #[error("{}: {ENVIRONMENT} has no plan of a run in shards; measure it again with --shard", .0.display())]
    NoPlan(PathBuf),
    /// A shard has not ended.
    #[error("{}: not finished; run its command again with --resume", .0.display())]
    Unfinished(PathBuf),
    /// A shard that cannot be resumed.
    #[error("{}: no {ENVIRONMENT} or no finished visit in it; run its command again with --replace", .0.display())]
    Nothing(PathBuf),
    /// A run that was not spread, in whose place the merged one would come.
    #[error("{}: holds a run of its own beside the shards; move its files elsewhere", .0.display())]
    Taken(PathBuf),
    /// Shards of different runs.
    #[error("{} has another {what} than {}; measure one of them again", .0.display(), .1.display(), what = .2)]
    Unlike(PathBuf, PathBuf, &'static str),
    /// Nobody has measured a scene of the run.
    #[error("{}: no shard has {scene}; run the missing one", .folder.display())]
    Missing {
        /// The run's folder.
        folder: PathBuf,
        /// The scene.
        scene: String,
    },
    /// Two shards have a scene.
    #[error("both {} and {} have {scene}; remove one of them", .0.display(), .1.display(), scene = .2)]
    Twice(PathBuf, PathBuf, String),
}

/// A shard on disk.
struct Part {
    folder: PathBuf,
    environment: Environment,
    rows: Vec<Row>,
}

impl Part {
    fn read(folder: PathBuf) -> Result<Self, MergeError> {
        let environment = results_dir::environment(&folder)?;
        match environment {
            Some(environment) if !environment.plan.is_object() => Err(MergeError::NoPlan(folder)),
            Some(environment) if environment.state == State::Complete => {
                let rows = row::read(&folder)?;
                Ok(Self { folder, environment, rows })
            }
            Some(_) if folder.join(SAMPLES).is_file() => Err(MergeError::Unfinished(folder)),
            _ => Err(MergeError::Nothing(folder)),
        }
    }

    fn has(&self, scene: &str) -> bool {
        self.rows.iter().any(|row| row.scene == scene)
    }

    /// Names of all scenes of the run.
    fn scenes(&self) -> Vec<String> {
        let names = self.environment.plan.get("all_scenes").and_then(serde_json::Value::as_array);
        names.into_iter().flatten().filter_map(|name| name.as_str().map(str::to_owned)).collect()
    }
}

/// Merges the shards below the folder of a run into the folder itself; where their machines are unlike, into a
/// folder of `machines` for each. What was merged before goes. Returns the folders written. The shards stay as they
/// are.
///
/// # Errors
/// [`MergeError`]: a shard is missing, not finished, or of another run.
pub fn merge(folder: &Path) -> Result<Vec<PathBuf>, MergeError> {
    let parts: Result<Vec<Part>, MergeError> = shards(folder).into_iter().map(Part::read).collect();
    let parts = parts?;
    if folder.join(SAMPLES).is_file() {
        return Err(MergeError::Taken(folder.to_owned()));
    }
    let Some(first) = parts.first() else { return Err(MergeError::None(folder.to_owned())) };
    parts.iter().try_for_each(|part| same_run(first, part))?;
    let scenes = first.scenes();
    if scenes.is_empty() {
        return Err(MergeError::NoPlan(first.folder.clone()));
    }
    for scene in &scenes {
        let mut having = parts.iter().filter(|part| part.has(scene));
        match (having.next(), having.next()) {
            (None, _) => return Err(MergeError::Missing { folder: folder.to_owned(), scene: scene.clone() }),
            (Some(a), Some(b)) => {
                return Err(MergeError::Twice(a.folder.clone(), b.folder.clone(), scene.clone()));
            }
            _ => {}
        }
    }
    let mut machines: Vec<Vec<&Part>> = Vec::new();
    for part in &parts {
        match machines
            .iter_mut()
            .find(|group| group.iter().all(|known| known.environment.is_alike(&part.environment)))
        {
            Some(group) => group.push(part),
            None => machines.push(vec![part]),
        }
    }
    let place = |index: usize| match machines.len() {
        1 => folder.to_owned(),
        _ => folder.join(MACHINES).join((index + 1).to_string()),
    };
    results_dir::remove_made_of_rows(folder, &[ROWS, ROUNDS, PHASES, ENVIRONMENT])?;
    let older = folder.join(MACHINES);
    if older.is_dir() {
        let remedy = "remove it by hand";
        std::fs::remove_dir_all(&older).map_err(|source| RecordsError::Io { path: older, source, remedy })?;
    }
    let groups = machines.iter().enumerate();
    groups.map(|(index, group)| write(group, &scenes, &place(index)).map_err(MergeError::from)).collect()
}

/// The folders of shards, by name.
fn shards(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder.join(SHARDS)).into_iter().flatten().filter_map(Result::ok);
    let mut shards: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    shards.sort();
    shards
}

/// What shards of a run have alike in their plans, and its name in words.
const PLAN: [(&str, &str); 4] = [
    ("settings", "plan"),
    ("all_scenes", "set of scenes"),
    ("all_cells", "set of builders"),
    ("filter", "filter"),
];

fn same_run(first: &Part, part: &Part) -> Result<(), MergeError> {
    let (a, b) = (&first.environment, &part.environment);
    let unlike = |what| Err(MergeError::Unlike(part.folder.clone(), first.folder.clone(), what));
    if a.program != b.program {
        return unlike("program");
    }
    if a.library.embree != b.library.embree {
        return unlike("Embree");
    }
    let mut other = PLAN.into_iter().filter(|(key, _)| a.plan.get(key) != b.plan.get(key));
    other.next().map_or(Ok(()), |(_, what)| unlike(what))
}

/// Writes the rows of some shards in the order of `scenes`, and their environment.
fn write(parts: &[&Part], scenes: &[String], folder: &Path) -> Result<PathBuf, RecordsError> {
    // Groups begin with a shard.
    let Some(first) = parts.first() else { return Ok(folder.to_owned()) };
    let of_scene = |scene: &String| {
        let rows = parts.iter().flat_map(|part| &part.rows).filter(|row| row.scene == *scene);
        rows.cloned().collect::<Vec<_>>()
    };
    let rows: Vec<Row> = scenes.iter().flat_map(of_scene).collect();
    let mut phases = Vec::new();
    for part in parts {
        phases.extend(phases::read(&part.folder)?);
    }
    // A stable sort: the phases of a scene keep their order.
    phases.sort_by_key(|phase| scenes.iter().position(|scene| *scene == phase.scene));
    new_folder(folder)?;
    let mut environment = first.environment.clone();
    let plans = || parts.iter().map(|part| &part.environment.plan);
    let scenes = plans().filter_map(|plan| plan.get("scenes")?.as_array()).flatten().cloned().collect();
    let shards = plans().map(|plan| plan.get("shard").cloned().unwrap_or_default()).collect();
    if let Some(plan) = environment.plan.as_object_mut() {
        plan.insert("scenes".into(), serde_json::Value::Array(scenes));
        plan.insert("shards".into(), serde_json::Value::Array(shards));
        plan.remove("shard");
    }
    environment.before = parts.iter().flat_map(|part| part.environment.before.clone()).collect();
    environment.before.sort_by(|a, b| a.utc.cmp(&b.utc));
    let after = parts.iter().filter_map(|part| part.environment.after.clone());
    environment.after = after.max_by(|a, b| a.utc.cmp(&b.utc));
    environment.notes = parts.iter().flat_map(|part| part.environment.notes.clone()).collect();
    phases::write(folder, &phases)?;
    environment.written = Some(row::write_all(folder, &rows)?);
    write_json(&folder.join(ENVIRONMENT), &environment)?;
    Ok(folder.to_owned())
}
