//! A run as one HTML file that needs nothing else: verdict, plots, table, pictures, and how it was measured.
//!
//! `data` has the figures, `words` what is told of machine and warnings, `attachments` the pictures beside the rows;
//! `page.html` is the template, `page.css` and the scripts beside it show what it holds. Plots are drawn by Observable
//! Plot over D3, both in `vendor` with their licences.

mod attachments;
mod data;
mod family;
mod words;

use crate::bench::environment::Environment;
use crate::bench::merge::SHARDS;
use crate::bench::results_dir::TABLE;
use crate::bench::results_dir::is_complete;
use crate::bench::row::Row;
use crate::bench::samples::SAMPLES;
use crate::report::figures::Under;
use crate::report::verdict::field::Field;
use crate::report::verdict::{Part, Sentence, verdict};
use attachments::Attachments;
use data::{Data, Named};
use family::{Family, families};
use minijinja::value::Serde;
use minijinja::{Environment as Templates, UndefinedBehavior};
use serde::Serialize;
use std::path::{Path, PathBuf};
use words::Item;

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// There are no rows.
    #[error("no rows; run `phr bench` again")]
    Empty,
    /// The figures cannot be written as JSON.
    #[error("report: {0}; report this with the results")]
    Json(#[from] serde_json::Error),
    /// The template does not fit.
    #[error("report: {0}; report this with the results")]
    Template(#[from] minijinja::Error),
}

const LIBRARIES: [&str; 2] = [include_str!("vendor/d3.min.js"), include_str!("vendor/plot.min.js")];
const LICENCES: [&str; 3] = [
    include_str!("vendor/d3.LICENSE"),
    include_str!("vendor/plot.LICENSE"),
    include_str!("vendor/bundled.LICENSE"),
];
const SCRIPTS: [&str; 5] = [
    include_str!("figures.js"),
    include_str!("front.js"),
    include_str!("totals.js"),
    include_str!("table.js"),
    include_str!("page.js"),
];

/// What the template shows.
#[derive(Serialize)]
struct Context<'a> {
    name: String,
    row: &'a Row,
    scene_count: usize,
    tree_count: usize,
    verdict: Vec<Vec<(&'static str, String)>>,
    is_complete: bool,
    base: &'a str,
    kernels: &'a [Named],
    regimes: &'a [Named],
    places: Vec<&'a str>,
    families: Vec<Family>,
    environment: Vec<Item>,
    warnings: Vec<Item>,
    errors: Vec<Item>,
    attachments: Attachments,
    has_table: bool,
    samples: Option<String>,
    data: String,
    style: &'static str,
    libraries: [&'static str; 2],
    licences: [&'static str; 3],
    scripts: [&'static str; 5],
    version: &'static str,
}

/// The page of the run of `rows`, whose `folder` may hold pictures, as may folders of `experiments`.
///
/// # Errors
/// Those of [`PageError`].
pub fn page(
    rows: &[Row],
    environment: Option<&Environment>,
    folder: &Path,
    experiments: &[PathBuf],
) -> Result<String, PageError> {
    let (Some(field), Some(row)) = (Field::of(rows), rows.first()) else { return Err(PageError::Empty) };
    let under = Under::best(rows);
    let data = Data::of(rows, &field);
    let name =
        folder.file_name().map_or_else(|| "results".into(), |name| name.to_string_lossy().into_owned());
    let mut templates = Templates::new();
    templates.set_undefined_behavior(UndefinedBehavior::Strict);
    templates.add_template("page.html", include_str!("page.html"))?;
    let context = Context {
        name,
        row,
        scene_count: field.scenes.len(),
        tree_count: field.trees.len(),
        verdict: verdict(&field, &under).into_iter().map(sentence).collect(),
        is_complete: is_complete(environment),
        base: &data.base,
        kernels: &data.kernels,
        regimes: &data.regimes,
        places: data.places.iter().map(|place| place.name.as_str()).collect(),
        families: families(field.trees.iter().map(|tree| tree.0)),
        environment: environment.map(words::environment).unwrap_or_default(),
        warnings: words::warnings(rows),
        errors: words::errors(rows),
        attachments: Attachments::of(folder, experiments),
        has_table: folder.join(TABLE).is_file(),
        samples: samples(folder),
        // Within a script, only this could end it.
        data: serde_json::to_string(&data)?.replace('<', "\\u003c"),
        style: include_str!("page.css"),
        libraries: LIBRARIES,
        licences: LICENCES,
        scripts: SCRIPTS,
        version: env!("CARGO_PKG_VERSION"),
    };
    Ok(templates.get_template("page.html")?.render(Serde(&context))?)
}

/// The files with every sample of a run, its own or those of its shards; `None` where they were not kept.
fn samples(folder: &Path) -> Option<String> {
    let has_samples = |folder: &Path| folder.join(SAMPLES).is_file();
    if has_samples(folder) {
        return Some(SAMPLES.into());
    }
    let mut shards = std::fs::read_dir(folder.join(SHARDS)).into_iter().flatten().flatten();
    shards.any(|shard| has_samples(&shard.path())).then(|| format!("{SHARDS}/*/{SAMPLES}"))
}

/// The parts of a sentence, each with its kind.
fn sentence(sentence: Sentence) -> Vec<(&'static str, String)> {
    let part = |part: Part| match part {
        Part::Name(text) => ("name", text),
        Part::Interval(text) => ("interval", text),
        Part::Words(text) => ("words", text),
    };
    sentence.0.into_iter().map(part).collect()
}

#[cfg(test)]
mod tests;
