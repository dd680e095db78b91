//! Files that the program reads back: each is read whole and shown, or refused by its name. The first byte chooses the
//! file.

use phr::bench::chosen::Chosen;
use phr::bench::files::read_csv_file;
use phr::bench::kernels::{leaks, row as kernels};
use phr::bench::samples::Samples;
use phr::bench::scaling::row as scaling;
use phr::bench::turns::row as turns;
use phr::bench::{phases, results_dir, rounds, row};
use phr::experiments::{animation, cut_size, heatmap, split};
use phr::report::advice::model::{Model, facts::SceneFacts};
use phr::report::advice::{rows as advice, tuned_rows};
use phr::report::compare::by_turns::{ByTurns, THRESHOLD};
use phr::report::evidence::{constants::constants, scaling::page as scaling_page};
use phr::report::figures::Under;
use phr::report::kernels::page as kernels_page;
use phr::report::plot;
use phr::report::table::document;
use std::cell::OnceCell;
use std::fmt::Display;
use std::path::Path;

/// Reads the file and shows what it says, or tells why it cannot.
type Reader = fn(&Path) -> Result<(), String>;

/// The files, each with who reads it.
static FILES: [(&str, Reader); 19] = [
    ("rows.csv", |path| {
        let rows = row::read(path).map_err(told)?;
        let _ = (document(&rows, true), plot::figures(&rows, &[], &Under::best(&rows)));
        Ok(())
    }),
    ("rounds.csv", |path| rounds::read(path, None).map(drop).map_err(told)),
    ("phases.csv", |path| phases::read(folder(path)).map(drop).map_err(told)),
    ("samples.json", |path| Samples::read(folder(path)).map(drop).map_err(told)),
    ("kernels.csv", |path| kernels::read(path).map(|rows| drop(kernels_page(&rows))).map_err(told)),
    ("leaks.csv", |path| leaks::read(path).map(drop).map_err(told)),
    ("scaling.csv", |path| scaling::read(path).map(|rows| drop(scaling_page(&rows))).map_err(told)),
    ("advice.csv", |path| {
        let rows = advice::read_all(folder(path)).map_err(told)?;
        rows.iter().for_each(|rows| drop(advice::lines(rows)));
        Ok(())
    }),
    ("tune.csv", |path| tuned_rows::page(folder(path)).map(drop).map_err(told)),
    ("animation.csv", |path| {
        let rows = animation::records::read(path).map_err(told)?;
        let _ = (animation::findings(&rows), animation::draw(&rows));
        Ok(())
    }),
    ("cut-size.csv", |path| {
        let rows: Vec<cut_size::CutSizeRow> = read_csv_file(path, "").map_err(told)?;
        let _ = (cut_size::findings(&rows), cut_size::draw(&rows));
        Ok(())
    }),
    ("split.csv", |path| {
        let rows: Vec<split::BoxRow> = read_csv_file(path, "").map_err(told)?;
        let pictures = split::pictures(&rows).map_err(|error| format!("{}: {error}", path.display()))?;
        pictures.iter().for_each(|picture| drop(split::draw(picture)));
        Ok(())
    }),
    ("map.csv", |path| {
        std::fs::write(path.with_extension("counts.png"), COUNTS).unwrap();
        heatmap::read(&path.with_extension("png")).map(drop).map_err(told)
    }),
    ("map.counts.png", |path| {
        let png = folder(path).join("map.png");
        std::fs::write(png.with_extension("csv"), MAP).unwrap();
        heatmap::read(&png).map(drop).map_err(told)
    }),
    ("environment.json", |path| results_dir::environment(folder(path)).map(drop).map_err(told)),
    ("builder.json", |path| {
        let chosen = Chosen::new(&[], &[], &[path]).map_err(told)?;
        chosen.cells(true).map(drop).map_err(told)
    }),
    ("model.json", |path| {
        let facts = SceneFacts { triangles: 1e5, sah: 40.0, epo: 5.0, leaf_fill: 0.8 };
        let model = Model::read(path).map_err(told)?;
        let _ = model.advise("hall", &facts, 1e8, &[4, 8]).winners();
        Ok(())
    }),
    ("chosen.csv", |path| {
        std::fs::write(folder(path).join("rows.csv"), NEIGHBOURS).unwrap();
        constants(folder(path)).map(drop)
    }),
    ("turns.csv", |path| {
        let rows = turns::read(path).map_err(told)?;
        let _ = ByTurns::of(&rows, THRESHOLD).document();
        Ok(())
    }),
];

/// The neighbours of the constants in the seed.
const NEIGHBOURS: &[u8] = include_bytes!("../records/neighbours.csv");
/// A heat map's records, of which one file is replaced.
const MAP: &[u8] = include_bytes!("../records/map.csv");
const COUNTS: &[u8] = include_bytes!("../records/map.counts.png");

thread_local! {
    static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() };
}

fn told(error: impl Display) -> String {
    error.to_string()
}

/// The line that is missing, as the error tells.
fn missing_line(error: &str) -> Option<&str> {
    error.rsplit_once("add the line `")?.1.strip_suffix('`')
}

fn folder(path: &Path) -> &Path {
    path.parent().expect("a file in a folder")
}

/// Whether the file was read whole.
pub fn check(data: &[u8]) -> bool {
    let Some((first, content)) = data.split_first() else { return false };
    let (file, read) = FILES[*first as usize % FILES.len()];
    FOLDER.with(|known| {
        let folder = known.get_or_init(|| tempfile::tempdir().unwrap()).path();
        std::fs::read_dir(folder).unwrap().for_each(|old| std::fs::remove_file(old.unwrap().path()).unwrap());
        let path = folder.join(file);
        std::fs::write(&path, content).unwrap();
        let mut found = read(&path);
        // What was made up hardly ever tells its number of rows: it does now.
        if let Some(line) = found.as_ref().err().and_then(|error| missing_line(error)) {
            std::fs::write(&path, [content, line.as_bytes(), b"\n"].concat()).unwrap();
            found = read(&path);
        }
        found.map_err(|error| assert!(error.contains(&*folder.to_string_lossy()), "{error}")).is_ok()
    })
}
