//! `phr heatmap`: Figure 1 of the paper, for any scene and builders.

use crate::bench::cell::Cell;
use crate::bench::files::{content, write_whole};
use crate::bench::planned_scene::PlannedScene;
use crate::cli::failure::Failure;
use crate::cli::options::{self, Made, all_threads, pools, width};
use crate::cli::output::say;
use crate::cli::place::{FileKind, check_place};
use crate::experiments::heatmap;
use crate::report::plot::raster;
use std::path::{Path, PathBuf};

/// The builders of the paper's Figure 1.
const FIGURE_1: [&str; 4] = ["embree-sah", "phr-fast", "phr-hq", "embree-fast-spatial"];

/// Draw the traversal steps of a view's primary rays under several builders side by side, as in the paper's Figure 1
///
/// Beside FILE.png stand FILE.csv (build times, mean, 95th percentile and most steps) and FILE.counts.png (the steps of
/// every pixel, 16-bit grey, one builder below the other).
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene file or name of a generated scene
    #[arg(required_unless_present_any = ["redraw", "check"])]
    scene: Option<String>,
    /// Builder (repeatable) [default: those of the paper's figure]
    #[arg(long = "builder", value_name = "NAME")]
    builders: Vec<String>,
    #[command(flatten)]
    made: Made,
    /// Children per node: 4 or 8 [default: the builder's least]
    #[arg(long, value_name = "N", value_parser = width)]
    width: Option<u32>,
    /// View, from 0
    #[arg(long, default_value_t = 0, value_name = "K")]
    view: usize,
    /// Pixels across and down
    #[arg(long, default_value_t = 512, value_name = "PIXELS")]
    size: u32,
    /// Steps of the brightest colour [default: what 99 of 100 pixels stay below]
    #[arg(long, value_name = "STEPS")]
    scale: Option<u32>,
    /// Threads [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// PNG file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Measure nothing: draw again from the files beside the picture
    #[arg(long, conflicts_with_all = MEASURED)]
    redraw: bool,
    /// Measure and draw nothing; fail if the picture is not that of the files beside it
    #[arg(long, conflicts_with_all = MEASURED, conflicts_with_all = ["scale", "redraw"])]
    check: bool,
}

/// What says how to measure.
const MEASURED: [&str; 8] = ["scene", "builders", "changes", "configs", "width", "view", "size", "threads"];

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    check_place(&arguments.output, FileKind::Png)?;
    if arguments.output.extension().is_none_or(|ending| ending != "png") {
        let output = arguments.output.display();
        return Err(Failure::Bad(format!(
            "{output}: a heat map is a PNG file; give a name that ends in .png"
        )));
    }
    if !(1..=heatmap::MOST_PIXELS).contains(&arguments.size) || arguments.scale == Some(0) {
        return Err(Failure::Bad(format!(
            "--size, --scale: give 1 to {} pixels and 1 or more steps",
            heatmap::MOST_PIXELS
        )));
    }
    if arguments.redraw || arguments.check {
        let mut panels = heatmap::read(&arguments.output)?;
        if let Some(scale) = arguments.scale {
            panels.iter_mut().for_each(|panel| panel.row.scale = scale);
            heatmap::write(&arguments.output, &panels)?;
        }
        let drawn = heatmap::draw(&panels)?;
        return if arguments.check {
            check(&arguments.output, &drawn)
        } else {
            Ok(write_whole(&arguments.output, &drawn)?)
        };
    }
    let [csv, counts] = heatmap::places(&arguments.output);
    check_place(&counts, FileKind::Png)?;
    if csv.exists() && heatmap::read(&arguments.output).is_err() {
        let csv = csv.display();
        return Err(Failure::Bad(format!(
            "{csv}: is there, and not of a heat map; remove it or give another name"
        )));
    }
    let pools = pools(arguments.threads.unwrap_or_else(all_threads))?;
    let scene = options::loaded(&PlannedScene::find(arguments.scene.as_deref().unwrap_or_default())?)?;
    let request = heatmap::Request {
        view: options::view(&scene, arguments.view).map(|_| arguments.view)?,
        scene: &scene,
        cells: &cells(arguments)?,
        size: arguments.size,
        scale: arguments.scale,
        pools: &pools,
    };
    let panels = heatmap::measure(&request).map_err(Failure::Wrong)?;
    heatmap::write(&arguments.output, &panels)?;
    write_whole(&arguments.output, &heatmap::draw(&panels)?)?;
    for panel in &panels {
        let row = &panel.row;
        say(&format!(
            "{} / {}: build {} ms; steps: mean {}, 95 % at most {}, most {}",
            row.builder, row.width, row.build_ms, row.steps_mean, row.steps_p95, row.steps_max
        ))?;
    }
    say(&arguments.output.display().to_string())
}

/// Fails if the file is not the picture `drawn`.
fn check(output: &Path, drawn: &[u8]) -> Result<(), Failure> {
    if content(output).is_ok_and(|there| raster::are_alike(&there, drawn)) {
        return Ok(());
    }
    let output = output.display();
    Err(Failure::Wrong(format!("{output}: not the picture of these counts; draw it again with --redraw")))
}

/// The builders asked for, or those of Figure 1 that this program has.
fn cells(arguments: &Arguments) -> Result<Vec<Cell>, Failure> {
    let widths = arguments.width.as_slice();
    if arguments.builders.is_empty() && arguments.made.is_empty() {
        let known = FIGURE_1
            .iter()
            .filter_map(|name| options::cells(&[(*name).into()], &Made::default(), widths).ok());
        return Ok(known.flatten().collect());
    }
    options::cells(&arguments.builders, &arguments.made, widths)
}
