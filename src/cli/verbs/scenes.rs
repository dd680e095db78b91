//! `phr scenes`: the generated scenes, which need no file.

use crate::cli::failure::Failure;
use crate::cli::output::say;
use crate::report::grid::Grid;
use crate::scene;

/// List the generated scenes: the built-in set, the stand-ins for the paper's nine, and those of any size
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
            let files = original.file_names.join(", ") + " (.ply, .obj, .glb, .gltf, .stl)";
            paper.push(vec![
                stand_in.name.into(),
                stand_in.triangles.to_string(),
                original.name.into(),
                files,
            ]);
        }
    }
    say(&(paper.markdown() + "\n"))?;
    let mut scalable = Grid::new(["of any size", "triangles", "what it is"]);
    let about = "statues, hair, trees, furniture, pipes and houses; more triangles are more of them";
    scalable.push(vec!["scalable-N, as in scalable-500k, scalable-32M".into(), "N".into(), about.into()]);
    say(&scalable.markdown())
}
