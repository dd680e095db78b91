//! Options that several verbs share: threads, builder, width and kernel.

use super::failure::Failure;
use super::note::note;
use crate::bench::cell::{Cell, Kernel};
use crate::bench::chosen::Chosen;
use crate::bench::contender;
use crate::bench::error::PlanError;
use crate::bench::planned_scene::{PlannedScene, plain_name};
use crate::bench::pools::Pools;
use crate::bench::settings::{MOST_SECONDS, MOST_THREADS};
use crate::scene::{Scene, View};
use crate::trace::scale::check_size;
use std::path::{Path, PathBuf};
use std::slice::from_ref;

/// Processors of this machine: the default of `--threads`.
pub fn all_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Refuses a number of threads that none could run on, or that no machine has.
///
/// # Errors
/// That it is.
pub fn check_threads(threads: usize) -> Result<(), Failure> {
    match threads {
        0 => Err(Failure::Bad("--threads 0: nothing could run; give 1 or more".into())),
        1..=MOST_THREADS => Ok(()),
        _ => Err(Failure::Bad(format!("--threads {threads}: more than {MOST_THREADS}; give fewer"))),
    }
}

/// The thread pool that `--threads` asks for.
///
/// # Errors
/// No threads, or more than the system has.
pub fn pools(threads: usize) -> Result<Pools, Failure> {
    check_threads(threads)?;
    let build = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = build.map_err(|error| Failure::Bad(format!("--threads {threads}: {error}; give fewer")))?;
    Ok(pool.into())
}

/// Builders that are made from others; alone they stand in place of the default.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Made {
    /// A builder with this field of its configuration changed (repeatable), beside those of --builder or alone:
    /// BUILDER.FIELD=VALUE, as phr-hq.delta=8; it is called phr-hq[delta=8]
    #[arg(long = "set", value_name = "CHANGE")]
    pub changes: Vec<String>,
    /// The builder of this file, likewise (repeatable): {"name": NAME, "base": BUILDER, "fields": {"FIELD": VALUE}}
    #[arg(long = "config", value_name = "FILE")]
    pub configs: Vec<PathBuf>,
}

impl Made {
    /// These beside the builders of `--builder`.
    ///
    /// # Errors
    /// Those of [`Chosen::new`].
    pub fn chosen(&self, builders: &[String]) -> Result<Chosen, PlanError> {
        Chosen::new(builders, &self.changes, &self.configs)
    }

    /// True where none is asked for.
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty() && self.configs.is_empty()
    }
}

/// The cells that `--builder`, `--set`, `--config` and `--width` ask for, builder by builder in the order of the
/// command line: of the `widths` that it has, or without any its smallest.
///
/// # Errors
/// No such builder, none of the widths, a file that cannot be used.
pub fn cells(builders: &[String], made: &Made, widths: &[u32]) -> Result<Vec<Cell>, Failure> {
    let Made { changes, configs } = made;
    // All together, since no two may have one name.
    made.chosen(builders)?;
    let none: [&Path; 0] = [];
    let named = builders.iter().map(|name| Chosen::new(from_ref(name), &[], &none));
    let changed = (!changes.is_empty()).then(|| Chosen::new(&[], changes, &none));
    let in_files = configs.iter().map(|file| Chosen::new(&[], &[], from_ref(file)));
    let mut cells = Vec::new();
    for chosen in named.chain(changed).chain(in_files) {
        let (chosen, before) = (chosen?, cells.len());
        cells.extend(chosen.cells(false)?.into_iter().filter(|cell| widths.contains(&cell.width)));
        if cells.len() == before {
            cells.extend(chosen.single_cells(widths.first().copied())?);
        }
    }
    Ok(distinct(&cells))
}

/// `values` in their order, each once.
pub fn distinct<T: PartialEq + Clone>(values: &[T]) -> Vec<T> {
    let mut distinct = Vec::new();
    for value in values {
        if !distinct.contains(value) {
            distinct.push(value.clone());
        }
    }
    distinct
}

/// Reads the width of trees: 4 or 8.
///
/// # Errors
/// Anything else.
pub fn width(text: &str) -> Result<u32, String> {
    text.parse().ok().filter(|width| [4, 8].contains(width)).ok_or_else(|| "give 4 or 8".into())
}

/// The kernel that `--kernel` asks for, of those that trace our trees; without one, the fairest.
///
/// # Errors
/// No such kernel.
pub fn kernel(name: Option<&str>) -> Result<Kernel, Failure> {
    let known = contender::kernels_of_ours();
    let named = name.map_or(known.first().copied(), Kernel::by_name);
    named.filter(|kernel| known.contains(kernel)).ok_or_else(|| {
        let name = name.unwrap_or_default();
        let known = known.iter().map(|kernel| kernel.name()).collect::<Vec<_>>().join(" and ");
        Failure::Bad(format!("--kernel {name}: our trees are traced by {known}"))
    })
}

/// Widths of trees that an option asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Widths(pub Vec<u32>);

/// Reads "4", "8" or "both".
///
/// # Errors
/// Anything else.
pub fn widths(text: &str) -> Result<Widths, String> {
    match text {
        "4" => Ok(Widths(vec![4])),
        "8" => Ok(Widths(vec![8])),
        "both" => Ok(Widths(vec![4, 8])),
        _ => Err("give 4, 8 or both".into()),
    }
}

/// Reads a number of rays: "50M", "1G", "3e8".
///
/// # Errors
/// Anything else.
pub fn rays(text: &str) -> Result<f64, String> {
    let units = [("k", 1e3), ("M", 1e6), ("G", 1e9), ("T", 1e12)];
    let found = units.iter().find_map(|(suffix, unit)| Some((text.strip_suffix(suffix)?, *unit)));
    let (number, unit) = found.unwrap_or((text, 1.0));
    let value = number.trim().parse::<f64>().ok().map(|number| number * unit);
    value
        .filter(|value| (1.0..=1e15).contains(value))
        .ok_or_else(|| "give a number of rays from 1 on, as 50M, 1G or 3e8".into())
}

/// The arguments without the folders of this machine.
pub fn command_line() -> Vec<String> {
    without_folders(std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned()))
}

/// The last part of what may be a path: of all but the values of `--filter` and `--shard`.
fn without_folders(arguments: impl Iterator<Item = String>) -> Vec<String> {
    let mut is_value = false;
    let shortened = |argument: String| {
        let keeps = is_value || ["--filter=", "--shard="].iter().any(|option| argument.starts_with(option));
        is_value = matches!(&*argument, "--filter" | "--shard");
        // The name of an option stays where its value is behind it.
        let (option, value) = match argument.split_once('=') {
            Some((option, value)) if option.starts_with("--") => (format!("{option}="), value),
            _ => (String::new(), &*argument),
        };
        match value.rsplit_once('/') {
            Some((_, file)) if !keeps => option + file,
            _ => argument,
        }
    };
    arguments.map(shortened).collect()
}

/// Reads a size in bytes: "500000", "512M", "4G".
///
/// # Errors
/// Anything else.
pub fn size(text: &str) -> Result<u64, String> {
    let unit = text.trim_start_matches(|letter: char| letter.is_ascii_digit());
    let factor = match unit.to_ascii_lowercase().trim_end_matches("ib") {
        "" => Some(1),
        "k" => Some(1 << 10),
        "m" => Some(1 << 20),
        "g" => Some(1 << 30),
        "t" => Some(1 << 40),
        _ => None,
    };
    let number = text.strip_suffix(unit).and_then(|number| number.parse::<u64>().ok());
    let size = number.zip(factor).and_then(|(number, factor): (u64, u64)| number.checked_mul(factor));
    size.filter(|size| *size > 0).ok_or_else(|| "give a size, as 512M or 4G".into())
}

/// Reads a number of seconds, at most a day.
///
/// # Errors
/// Anything else.
pub fn seconds(text: &str) -> Result<u64, String> {
    let value = text.parse().ok().filter(|value| *value <= MOST_SECONDS);
    value.ok_or_else(|| format!("give a whole number of seconds, at most {MOST_SECONDS}"))
}

/// Refuses the name that `option` asks for where it is none in a folder or a table.
///
/// # Errors
/// The name, in one line.
pub fn check_name(option: &str, name: &str) -> Result<(), Failure> {
    if !name.is_empty() && name == plain_name(name) && !name.contains(['/', '\\']) && !name.starts_with('.') {
        return Ok(());
    }
    let name = name.escape_debug();
    Err(Failure::Bad(format!("--{option} {name}: give a name of letters, digits, - and _")))
}

/// Loads a scene, telling what of its file is not in the mesh.
///
/// # Errors
/// A file that cannot be used.
pub fn loaded(planned: &PlannedScene) -> Result<Scene, Failure> {
    let scene = planned.load()?;
    scene.remarks().iter().for_each(|remark| note(remark));
    Ok(scene)
}

/// Loads a scene whose rays are to be traced, likewise.
///
/// # Errors
/// Also one so large or small that single precision loses hits.
pub fn traceable(planned: &PlannedScene) -> Result<Scene, Failure> {
    let scene = loaded(planned)?;
    check_size(&scene.mesh).map_err(|why| Failure::Bad(format!("{}: {why}", scene.name)))?;
    Ok(scene)
}

/// The view that `--view` asks for.
///
/// # Errors
/// The scene has none of that index.
pub fn view(scene: &Scene, wanted: usize) -> Result<&View, Failure> {
    let (name, views) = (&scene.name, scene.views.len());
    scene.views.get(wanted).ok_or_else(|| {
        let last = views.saturating_sub(1);
        Failure::Bad(format!("--view {wanted}: {name} has {views} views; give 0 to {last}"))
    })
}

/// What a scene holds, by which it is seen whether its file was read rightly: `20224 triangles of 3 objects`.
pub fn held(scene: &Scene) -> String {
    let triangles = scene.mesh.len();
    match scene.contents.objects {
        0 | 1 => format!("{triangles} triangles"),
        objects => format!("{triangles} triangles of {objects} objects"),
    }
}

/// Reads "5%" as 0.05.
///
/// # Errors
/// Anything else.
pub fn percent(text: &str) -> Result<f64, String> {
    let value = text.strip_suffix('%').and_then(|number| number.trim().parse::<f64>().ok());
    match value {
        Some(value) if value > 0.0 && value < 100.0 => Ok(0.01 * value),
        _ => Err("give a percentage above 0 and below 100, as 5%".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_cut_and_what_only_looks_like_one_is_not() {
        let given =
            ["bench", "../a/b.ply", "--filter", "a/b", "--shard", "1/10", "--filter=c/d", "--out", "x/y"];
        let kept = ["bench", "b.ply", "--filter", "a/b", "--shard", "1/10", "--filter=c/d", "--out", "y"];
        assert_eq!(without_folders(given.into_iter().map(str::to_owned)), kept);
    }
}
