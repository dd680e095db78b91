//! Options that several verbs share: threads, builder and width.

use super::failure::Failure;
use crate::bench::cell::Cell;
use crate::bench::chosen::Chosen;
use crate::bench::pools::Pools;
use std::path::Path;

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
    let none: [&Path; 0] = [];
    let cells = Chosen::new(&[builder.to_owned()], &[], &none)?.single_cells(width)?;
    Ok(cells.into_iter().next().unwrap_or_else(|| unreachable!("each builder has a cell")))
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
