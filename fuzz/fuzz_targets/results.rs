//! Records read back: rows, rounds and samples are read whole or refused in one line. The first byte chooses the file.

#![no_main]

use libfuzzer_sys::fuzz_target;
use phr::bench::files::{RecordsError, last_line};
use phr::bench::samples::Samples;
use phr::bench::{phases, rounds, row};
use phr::report::figures::Under;
use phr::report::table::document;
use std::cell::OnceCell;

thread_local! {
    static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() };
}

fuzz_target!(init: phr_fuzz::one_thread(), |data: &[u8]| {
    let Some((first, content)) = data.split_first() else { return };
    FOLDER.with(|folder| {
        let folder = folder.get_or_init(|| tempfile::tempdir().unwrap()).path();
        let one_line = |error: String| assert_eq!(error.lines().count(), 1, "{error}");
        let place = |file: &str| {
            for other in ["rows.csv", "rounds.csv", "phases.csv", "samples.json"] {
                let _ = std::fs::remove_file(folder.join(other));
            }
            std::fs::write(folder.join(file), content).unwrap();
        };
        match first % 4 {
            0 => {
                place("rows.csv");
                let mut read = row::read(folder);
                if let Err(RecordsError::Uncounted { found, .. }) = read {
                    // As the error tells.
                    let closed = [content, last_line(found).as_bytes()].concat();
                    std::fs::write(folder.join("rows.csv"), closed).unwrap();
                    read = row::read(folder);
                }
                match read {
                    Ok(rows) => {
                        let _ = (document(&rows, true), Under::best(&rows));
                    }
                    Err(error) => one_line(error.to_string()),
                }
            }
            1 => {
                place("rounds.csv");
                rounds::read(&folder.join("rounds.csv"), None)
                    .map_or_else(|error| one_line(error.to_string()), |_| ());
            }
            2 => {
                place("phases.csv");
                phases::read(folder).map_or_else(|error| one_line(error.to_string()), |_| ());
            }
            _ => {
                place("samples.json");
                Samples::read(folder).map_or_else(|error| one_line(error.to_string()), |_| ());
            }
        }
    });
});
