//! Results files that were cut, at a row's end too: refused in one line that names the file and what to do. Those of a
//! run are cut in `faults.rs`, with their environment; here they have none.
use phr::bench::files::{last_line, read_csv_file};
use phr::bench::kernels::{leaks, row as kernels};
use phr::bench::{phases, rounds, row, scaling::row as scaling};
use phr::experiments::cut_size::{CUT_SIZES, CutSizeRow};
use phr::experiments::split::{BoxRow, SPLITS};
use phr::experiments::{animation, heatmap};
use phr::report::advice::{rows as advice, tuned_rows};
use std::fmt::{Debug, Display};
use std::path::Path;

/// Reads a folder that holds one file.
type Read = fn(&Path) -> Result<String, String>;

fn shown<T: Debug, E: Display>(read: Result<T, E>) -> Result<String, String> {
    read.map(|rows| format!("{rows:?}")).map_err(|error| error.to_string())
}

/// A committed file of each kind, and who reads it.
const KINDS: [(&str, Read); 12] = [
    ("reference/rows.csv", |folder| shown(row::read(folder))),
    ("reference/rounds.csv", |folder| shown(rounds::read(&folder.join(rounds::ROUNDS), None))),
    ("kernel/kernels.csv", |folder| shown(kernels::read(folder))),
    ("leaks/leaks.csv", |folder| shown(leaks::read(folder))),
    ("scaling/scaling.csv", |folder| shown(scaling::read(folder))),
    ("animation/animation.csv", |folder| shown(animation::records::read(folder))),
    ("advice/rooms/advice.csv", |folder| shown(advice::read_all(folder))),
    ("tune/rooms/tune.csv", |folder| shown(tuned_rows::page(folder))),
    ("saved/phases.csv", |folder| shown(phases::read(folder))),
    ("experiments/cut-size/cut-size.csv", |folder| {
        shown(read_csv_file::<CutSizeRow>(&folder.join(CUT_SIZES), "measure"))
    }),
    ("experiments/split/split.csv", |folder| shown(read_csv_file::<BoxRow>(&folder.join(SPLITS), "measure"))),
    // Its pictures have four panels.
    ("experiments/heatmap/sanmiguel_partial.csv", |folder| {
        shown(heatmap::records::read(&folder.join("sanmiguel_partial.png")))
    }),
];

#[test]
fn a_cut_file_of_any_kind_is_refused() {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
    for (place, read) in KINDS {
        let folder = tempfile::tempdir().unwrap();
        let committed = results.join(place);
        let name = committed.file_name().unwrap().to_str().unwrap();
        let counts = committed.with_extension("counts.png");
        if counts.is_file() {
            std::fs::copy(&counts, folder.path().join(counts.file_name().unwrap())).unwrap();
        }
        // A few rows, to be read at every byte.
        let text = std::fs::read_to_string(&committed).unwrap();
        let rows: Vec<&str> = text.lines().take(5).collect();
        assert!(rows.len() == 5 && rows.iter().all(|row| row.matches('"').count() % 2 == 0), "{place}");
        let whole = rows.join("\n") + "\n" + &last_line(4);
        let cut = |end: usize| {
            let path = folder.path().join(name);
            std::fs::write(&path, &whole[..end]).unwrap();
            let said = read(folder.path());
            // Some file systems wait for the disk when a file is replaced, not when it is gone before.
            std::fs::remove_file(path).unwrap();
            said
        };
        cut(whole.len()).unwrap_or_else(|error| panic!("{place}: {error}"));
        for end in 0..whole.len() {
            match cut(end) {
                Ok(read) => panic!("{place}: {end} of {} bytes are taken for all: {read}", whole.len()),
                Err(told) => assert!(told.contains(name) && told.lines().count() == 1, "{place}: {told}"),
            }
        }
        // At a row's end.
        let told = cut(whole.len() - last_line(4).len()).unwrap_err();
        assert!(
            told.contains("no last line `# rows: N`") && told.contains("; if its 4 rows are all"),
            "{told}"
        );
    }
}
