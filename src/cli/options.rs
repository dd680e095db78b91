//! Options that several verbs share: threads, builder and width.

use super::failure::Failure;
use crate::bench::cell::Cell;
use crate::bench::contender;
use crate::bench::pools::Pools;
use crate::scene::Scene;

/// Processors of this machine: the default of `--threads`.
pub fn all_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// The thread pool that `--threads` asks for.
///
/// # Errors
/// No threads, or more than the system has.
pub fn pools(threads: usize) -> Result<Pools, Failure> {
    if threads == 0 {
        return Err(Failure::Bad("--threads 0: nothing could run; give 1 or more".into()));
    }
    let build = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = build.map_err(|error| Failure::Bad(format!("--threads {threads}: {error}; give fewer")))?;
    Ok(pool.into())
}

/// The cell that `--builder` and `--width` ask for; without a width, the builder's smallest.
///
/// # Errors
/// No such builder, or none of that width.
pub fn cell(builder: &str, width: Option<u32>) -> Result<Cell, Failure> {
    let cells = contender::cells(false);
    let of_builder: Vec<&Cell> = cells.iter().filter(|cell| cell.builder == builder).collect();
    if of_builder.is_empty() {
        let mut known: Vec<&str> = cells.iter().map(|cell| cell.builder.as_str()).collect();
        known.dedup();
        return Err(Failure::Bad(format!("no builder is called {builder}; there are {}", known.join(", "))));
    }
    let found = of_builder.iter().find(|cell| width.is_none_or(|width| cell.width == width));
    let no_width = || {
        let widths: Vec<String> = of_builder.iter().map(|cell| cell.width.to_string()).collect();
        let width = width.unwrap_or_default();
        Failure::Bad(format!("--width {width}: {builder} builds trees of width {}", widths.join(" and ")))
    };
    found.map(|&cell| cell.clone()).ok_or_else(no_width)
}

/// The index of the view that `--view` asks for.
///
/// # Errors
/// The scene has none of that index.
pub fn view(scene: &Scene, wanted: usize) -> Result<usize, Failure> {
    let (name, views) = (&scene.name, scene.views.len());
    if wanted < views {
        return Ok(wanted);
    }
    Err(Failure::Bad(format!("--view {wanted}: {name} has {views} views; give 0 to {}", views - 1)))
}

/// Reads "5%" as 0.05.
///
/// # Errors
/// Anything else.
pub fn percent(text: &str) -> Result<f64, String> {
    let value = text.strip_suffix('%').and_then(|number| number.trim().parse::<f64>().ok());
    match value {
        Some(value) if value >= 0.0 && value.is_finite() => Ok(0.01 * value),
        _ => Err("give a percentage, as 5%".into()),
    }
}
