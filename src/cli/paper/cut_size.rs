//! `phr experiment cut-size`: Figure 4 of the paper.

use super::arguments::Arguments;
use super::told;
use crate::bench::files::{new_folder, read_csv_file, write_csv};
use crate::bench::planned_scene::PlannedScene;
use crate::cli::failure::Failure;
use crate::cli::options::{all_threads, loaded, pools};
use crate::experiments::cut_size::{self, BUILDERS, CUT_SIZES, CutSizeRow};
use crate::report::plot::Drawing;
use crate::scene;

/// Name of the experiment.
pub const NAME: &str = "cut-size";

/// Counts, draws and tells.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.check_for_a_build(CUT_SIZES)?;
    let folder = arguments.folder();
    let path = folder.join(CUT_SIZES);
    let rows = if arguments.only_reads() {
        read_csv_file(&path, "run `phr experiment cut-size` without --redraw and --check first")?
    } else {
        let rows = measure(arguments)?;
        new_folder(&folder)?;
        write_csv(&path, &rows)?;
        rows
    };
    let svg = cut_size::draw(&rows).unwrap_or_default();
    let drawings = [Drawing { name: NAME, svg }];
    let act = if arguments.check { told::compare } else { told::write };
    act(&cut_size::findings(&rows), &drawings, &folder)
}

fn measure(arguments: &Arguments) -> Result<Vec<CutSizeRow>, Failure> {
    let pools = pools(arguments.threads.unwrap_or_else(all_threads))?;
    let builtin = || scene::builtin().iter().map(|generator| generator.name.to_owned()).collect();
    let names = if arguments.scenes.is_empty() { builtin() } else { arguments.scenes.clone() };
    let planned = PlannedScene::find_all(&names)?;
    let mut rows = Vec::new();
    for scene in planned {
        let scene = loaded(&scene)?;
        rows.extend(pools.all.install(|| cut_size::measure(&scene, &BUILDERS)).map_err(Failure::Bad)?);
    }
    Ok(rows)
}
