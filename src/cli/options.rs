//! Options that several verbs share: threads, builder and width.

use super::failure::Failure;
use crate::bench::cell::Cell;
use crate::bench::contender;
use crate::bench::pools::Pools;
use crate::bench::settings::MOST_THREADS;

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
    if threads > MOST_THREADS {
        return Err(Failure::Bad(format!("--threads {threads}: more than {MOST_THREADS}; give less")));
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

/// The arguments without the folders of this machine.
pub fn command_line() -> Vec<String> {
    let without_folder = |argument: String| match argument.rsplit_once('/') {
        Some((_, file)) if !argument.starts_with("--filter") => file.to_owned(),
        _ => argument,
    };
    std::env::args().skip(1).map(without_folder).collect()
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
    let number = text[..text.len() - unit.len()].parse::<u64>().ok();
    let size = number.zip(factor).and_then(|(number, factor): (u64, u64)| number.checked_mul(factor));
    size.filter(|size| *size > 0).ok_or_else(|| "give a size, as 512M or 4G".into())
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
