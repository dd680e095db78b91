//! `phr scenes`: what can be run without a file.

use super::{Failure, say};
use crate::report::grid::Grid;
use crate::scene;

/// List the generated scenes: the built-in set and the stand-ins for the paper's nine
#[derive(Debug, clap::Args)]
pub struct Arguments {}

/// Runs the verb.
pub fn run(_: &Arguments) -> Result<(), Failure> {
    let mut builtin = Grid::new(["built-in (--set builtin)", "triangles", "what it is"]);
    for generator in scene::builtin() {
        builtin.push(vec![generator.name.into(), generator.triangles.to_string(), generator.about.into()]);
    }
    say(&(builtin.markdown() + "\n"))?;
    let mut paper =
        Grid::new(["stand-in (--set paper)", "triangles", "for the paper's", "found with --scenes DIR as"]);
    for original in scene::paper() {
        if let Some(stand_in) = original.stand_in() {
            let files = original.file_names.join(", ") + " (.ply, .obj)";
            paper.push(vec![
                stand_in.name.into(),
                stand_in.triangles.to_string(),
                original.name.into(),
                files,
            ]);
        }
    }
    say(&paper.markdown())
}
