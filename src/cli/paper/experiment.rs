//! `phr experiment`: the paper's experiments, and the figures that look into a build.

use super::arguments::Arguments;
use super::cut_size;
use crate::cli::failure::Failure;

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.name == cut_size::NAME {
        return cut_size::run(arguments);
    }
    Err(Failure::Bad(format!("no experiment is called {}; there is {}", arguments.name, cut_size::NAME)))
}
