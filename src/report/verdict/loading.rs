//! What is told of saved trees: how long each takes to load, beside a build by the builder that made it.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]

use super::field::Field;
use super::sentence::Sentence;
use crate::bench::cell::is_saved;
use crate::report::figures::{SceneFigures, Tree};
use crate::report::grid::short;
use serde_json::Value;

/// A sentence for each saved tree in each scene that it was loaded for.
pub(super) fn loading(field: &Field<'_>) -> Vec<Sentence> {
    let mut sentences = Vec::new();
    for scene in &field.scenes {
        // Which scene goes without saying where there is one.
        let of = if field.scenes.len() > 1 { format!(" for {}", scene.scene()) } else { String::new() };
        for &tree in field.trees.iter().filter(|tree| is_saved(tree.0)) {
            sentences.extend(of_tree(scene, tree, &of));
        }
    }
    sentences
}

fn of_tree(scene: &SceneFigures<'_>, tree: Tree<'_>, of: &str) -> Option<Sentence> {
    let loaded = build_ms(scene, tree)?;
    let sentence = Sentence::default().name(tree).words(format!(" loads in {loaded} ms{of}"));
    let builder = builder_of(scene, tree).unwrap_or_default();
    Some(match build_ms(scene, (&builder, tree.1)) {
        Some(built) => sentence
            .words("; ")
            .name((&builder, tree.1))
            .words(format!(", which built it, takes {built} ms.")),
        None => sentence.words("."),
    })
}

/// The time of a build, that of loading for a saved tree.
fn build_ms(scene: &SceneFigures<'_>, tree: Tree<'_>) -> Option<String> {
    scene.build(tree).value()?.build_ms_median.map(short)
}

/// The builder that the file of a saved tree names. Rows that were reduced tell it once.
fn builder_of(scene: &SceneFigures<'_>, (name, width): Tree<'_>) -> Option<String> {
    let rows = scene.totals().iter().filter(|row| (row.builder.as_str(), row.width) == (name, width));
    let config = rows.map(|row| row.builder_config.as_str()).find(|config| !config.is_empty())?;
    let config: Value = serde_json::from_str(config).ok()?;
    config.get("builder")?.as_str().map(Into::into)
}
