//! `phr plot`: the figures of a run, from its CSV.

use super::table::under;
use crate::bench::files::write_whole;
use crate::bench::row::{self};
use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::report::plot::{self, raster};
use std::path::PathBuf;

/// Pixels of a PNG for each of the drawing's.
const SCALE: f32 = 2.0;

/// Draw the figures of a results folder as SVG and PNG: Figure 6, build time against trace time, averaged and by
/// scene; growth, where it has scalable scenes
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
    /// Draw nothing; fail if the SVG files there are not those of the CSV
    #[arg(long)]
    check: bool,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let rows = row::read(&arguments.results)?;
    let under = under(arguments.kernel.as_deref(), &rows)?;
    let drawings = plot::figures(&rows, &under);
    if drawings.is_empty() {
        let results = arguments.results.display();
        return Err(Failure::Bad(format!(
            "{results}: no tree was traced beside Embree SAH under {}, nor built in two scalable scenes; run `phr bench` \
             with embree-sah, or scalable-1M scalable-2M",
            under.name()
        )));
    }
    let results = &arguments.results;
    let beside = if results.is_dir() { results.clone() } else { results.with_file_name("") };
    let folder = arguments.out.clone().unwrap_or(beside);
    for drawing in drawings {
        let (svg, png) = (
            folder.join(drawing.name).with_extension("svg"),
            folder.join(drawing.name).with_extension("png"),
        );
        if arguments.check {
            let found = std::fs::read_to_string(&svg).unwrap_or_default();
            if found != drawing.svg {
                let svg = svg.display();
                return Err(Failure::Wrong(format!("{svg}: not the figure of these rows; run `phr plot`")));
            }
            continue;
        }
        write_whole(&svg, drawing.svg.as_bytes())?;
        write_whole(&png, &raster::png(&drawing.svg, SCALE)?)?;
        say(&format!("{}\n{}", svg.display(), png.display()))?;
    }
    Ok(())
}
