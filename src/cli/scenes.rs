//! `phr scenes`: what can be run without a file.

use super::{Failure, say};
use crate::report::grid::Grid;
use crate::scene;

/// List the generated scenes: the built-in set and the stand-ins for the paper's nine
#[derive(Debug, clap::Args)]
pub struct Arguments {}

/// Runs the verb.
pub fn run(_: &Arguments) -> Result<(), Failure> {
    let mut builtin = Grid::new(["built-in", "triangles", "what it is"]);
    for generator in scene::builtin() {
        builtin.push(vec![generator.name.into(), generator.triangles.to_string(), generator.about.into()]);
    }
    say(&builtin.markdown())
}
