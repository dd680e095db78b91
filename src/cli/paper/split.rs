//! `phr experiment split`: Figures 3 and 5 of the paper.

use super::arguments::Arguments;
use crate::bench::files::new_folder;
use crate::bench::files::{read_csv_file, write_csv};
use crate::bench::planned_scene::PlannedScene;
use crate::cli::failure::Failure;
use crate::cli::note::note;
use crate::cli::options::{all_threads, loaded, pools};
use crate::cli::output::say;
use crate::cli::verbs::plot::{check, draw};
use crate::experiments::split::{self, BoxRow, Kind, SPLITS};
use crate::report::plot::Drawing;

/// Name of the experiment.
pub const NAME: &str = "split";

/// The scene and the builder that are shown.
const SCENE: &str = "rooms";
const BUILDER: &str = "phr-fast";

/// Finds splits and draws them.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.check_for_a_build(SPLITS)?;
    let folder = arguments.folder();
    let path = folder.join(SPLITS);
    let rows: Vec<BoxRow> = if arguments.only_reads() {
        read_csv_file(&path, "run `phr experiment split` without --redraw and --check first")?
    } else {
        let rows = find(arguments)?;
        new_folder(&folder)?;
        write_csv(&path, &rows)?;
        rows
    };
    let pictures = split::pictures(&rows).map_err(|reason| {
        Failure::Bad(format!("{}: {reason}; run `phr experiment split` again", path.display()))
    })?;
    let drawings: Vec<Drawing> = pictures
        .iter()
        .map(|picture| Drawing { name: picture.kind.file(), svg: split::draw(picture) })
        .collect();
    if arguments.check {
        return check(&drawings, &folder);
    }
    let files = draw(&drawings, &folder)?;
    say(&files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>().join("\n"))
}

fn find(arguments: &Arguments) -> Result<Vec<BoxRow>, Failure> {
    let pools = pools(arguments.threads.unwrap_or_else(all_threads))?;
    let name = match &arguments.scenes[..] {
        [] => SCENE,
        [scene] => scene,
        _ => return Err(Failure::Bad("split: a picture is of one scene; give one".into())),
    };
    let scene = loaded(&PlannedScene::find(name)?)?;
    let mut rows = Vec::new();
    for kind in Kind::ALL {
        let found = pools.all.install(|| split::choose(&scene, BUILDER, kind)).map_err(Failure::Bad)?;
        match found {
            Some(picture) => rows.extend(split::of_picture(&picture)),
            None => note(&format!(
                "{}: nothing for {}, no split of a few nodes shows all steps; give another scene",
                scene.name,
                kind.file()
            )),
        }
    }
    if rows.is_empty() {
        return Err(Failure::Wrong(format!(
            "{}: nothing to draw; give another scene, such as {SCENE}",
            scene.name
        )));
    }
    Ok(rows)
}
