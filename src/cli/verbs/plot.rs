//! `phr plot`: the figures of a run, from its CSV.

use super::pages::table::under;
use crate::bench::files::{content, new_folder, text, write_whole};
use crate::bench::row::ROWS;
use crate::bench::scaling::row::{self as scaling, SCALING};
use crate::bench::{phases, row};
use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::report::plot::{self, Drawing, raster};
use std::path::{Path, PathBuf};

/// Draw the figures of a results folder as SVG and PNG: Figure 6, build time against trace time, averaged and by
/// scene; growth, where it has scalable scenes; phases of builds, where it knows them; of a folder of `phr scaling`,
/// builds by workers
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Results folder, or a rows.csv
    results: PathBuf,
    /// Folder of the figures [default: the results']
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Compare traces under embree-grafted, embree-native, phr, or each tree under its own [default:
    /// embree-grafted if the run has it, else own]
    #[arg(long, value_name = "KERNEL")]
    kernel: Option<String>,
    /// Draw nothing; fail if the SVG and PNG files there are not those of the CSV
    #[arg(long)]
    check: bool,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let results = &arguments.results;
    let drawings = if results.join(SCALING).is_file() && !results.join(ROWS).is_file() {
        if let Some(kernel) = &arguments.kernel {
            return Err(Failure::Bad(format!("--kernel {kernel}: of builds alone; leave it out")));
        }
        of_scaling(results)?
    } else {
        of_run(results, arguments.kernel.as_deref())?
    };
    let beside = if results.is_dir() { results.clone() } else { results.with_file_name("") };
    let folder = arguments.out.clone().unwrap_or(beside);
    if arguments.check {
        return check(&drawings, &folder);
    }
    new_folder(&folder)?;
    for file in draw(&drawings, &folder)? {
        say(&file.display().to_string())?;
    }
    Ok(())
}

/// The figures of a run.
fn of_run(results: &Path, kernel: Option<&str>) -> Result<Vec<Drawing>, Failure> {
    let rows = row::read(results)?;
    let under = under(kernel, &rows)?;
    let drawings = plot::figures(&rows, &phases::read(results)?, &under);
    if drawings.is_empty() {
        let results = results.display();
        return Err(Failure::Bad(format!(
            "{results}: no tree was traced beside Embree SAH under {}, nor built in two scalable scenes; run `phr bench` \
             with embree-sah, or scalable-1M scalable-2M",
            under.name()
        )));
    }
    Ok(drawings)
}

/// The figure of `phr scaling`.
fn of_scaling(results: &Path) -> Result<Vec<Drawing>, Failure> {
    let svg = plot::workers::workers(&scaling::read(results)?).ok_or_else(|| {
        let results = results.display();
        Failure::Bad(format!("{results}: schedules of one number of workers; run `phr scaling` with more"))
    })?;
    Ok(vec![Drawing { name: "scaling", svg }])
}

/// Writes each drawing to `folder` as SVG and PNG; returns the files.
///
/// # Errors
/// An unwritable place.
pub fn draw(drawings: &[Drawing], folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut files = Vec::new();
    for drawing in drawings {
        let svg = folder.join(drawing.name).with_extension("svg");
        let png = svg.with_extension("png");
        write_whole(&svg, drawing.svg.as_bytes())?;
        write_whole(&png, &raster::png(&drawing.svg)?)?;
        files.extend([svg, png]);
    }
    Ok(files)
}

/// Fails at the first SVG or PNG in `folder` that differs from its drawing.
///
/// # Errors
/// That file.
pub fn check(drawings: &[Drawing], folder: &Path) -> Result<(), Failure> {
    for drawing in drawings {
        let svg = folder.join(drawing.name).with_extension("svg");
        if text(&svg).unwrap_or_default() != drawing.svg {
            return Err(stale(&svg));
        }
    }
    // Texts are compared in no time, pixels are not.
    for drawing in drawings {
        let png = folder.join(drawing.name).with_extension("png");
        if !raster::shows(&content(&png).unwrap_or_default(), &drawing.svg)? {
            return Err(stale(&png));
        }
    }
    Ok(())
}

fn stale(file: &Path) -> Failure {
    let is_there = file.exists();
    let file = file.display();
    if !is_there {
        return Failure::Wrong(format!("{file}: no such figure; draw it with `phr plot` or --redraw"));
    }
    Failure::Wrong(format!("{file}: not the figure of these rows; draw it again with `phr plot` or --redraw"))
}
