//! What stands beside the rows in a results folder: table, plots and page.

use super::report::write_page;
use crate::bench::files::write_whole;
use crate::bench::phases;
use crate::bench::results_dir::{PAGE, TABLE};
use crate::bench::row::Row;
use crate::cli::failure::Failure;
use crate::cli::verbs::plot::draw;
use crate::report::figures::Under;
use crate::report::{plot, table};
use std::path::{Path, PathBuf};

/// Writes table, plots and page of the `rows` in `folder`, a whole run's or not; the plots' files.
///
/// # Errors
/// An unwritable place.
pub fn made_of_rows(rows: &[Row], is_complete: bool, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    write_whole(&folder.join(TABLE), table::document(rows, is_complete).as_bytes())?;
    let plots = draw(&plot::figures(rows, &phases::read(folder)?, &Under::best(rows)), folder)?;
    write_page(folder, &[], &folder.join(PAGE))?;
    Ok(plots)
}
