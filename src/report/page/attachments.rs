//! Pictures and tables that lie in a results folder beside the rows: heat maps, experiments and other figures.

use crate::bench::files::RecordsError;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Lines of a table that the page shows; the file has all.
const LINES: usize = 200;
/// Subfolders of heat maps and of experiments.
const HEAT_MAPS: [&str; 2] = ["heatmaps", "heatmap"];
const EXPERIMENTS: &str = "experiments";

/// A picture or a table.
#[derive(Debug, Serialize)]
pub struct Attachment {
    /// Name of the file without its ending, as words.
    pub title: String,
    /// The file, relative to the folder.
    pub file: String,
    /// The picture as a data URI.
    image: Option<String>,
    /// The table: header and lines.
    table: Option<Vec<Vec<String>>>,
    /// Lines of the table that are not shown.
    more: usize,
}

/// What lies in a folder.
#[derive(Debug, Default, Serialize)]
pub struct Attachments {
    /// PNG files whose name begins with `heat`, or in a folder `heatmaps`.
    pub heat_maps: Vec<Attachment>,
    /// SVG and CSV files in the folder `experiments`.
    pub experiments: Vec<Attachment>,
    /// Other SVG files, but for Figure 6, which the page draws itself.
    pub figures: Vec<Attachment>,
}

impl Attachments {
    /// Those of `folder`.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn of(folder: &Path) -> Result<Self, RecordsError> {
        let is_heat = |file: &PathBuf| name(file).starts_with("heat");
        let heat_maps = files(folder, "png").into_iter().filter(is_heat);
        let below = HEAT_MAPS.iter().flat_map(|below| files(&folder.join(below), "png"));
        let experiments = folder.join(EXPERIMENTS);
        let mut of_experiments = files(&experiments, "svg");
        of_experiments.extend(files(&experiments, "csv"));
        // A picture stands before its figures.
        of_experiments
            .sort_by(|a, b| a.file_stem().cmp(&b.file_stem()).then(b.extension().cmp(&a.extension())));
        let figures = files(folder, "svg").into_iter().filter(|file| !name(file).starts_with("figure6"));
        let read = |files: Vec<PathBuf>| -> Result<Vec<Attachment>, RecordsError> {
            files.iter().map(|file| Attachment::of(folder, file)).collect()
        };
        Ok(Self {
            heat_maps: read(heat_maps.chain(below).collect::<Vec<_>>())?,
            experiments: read(of_experiments)?,
            figures: read(figures.collect())?,
        })
    }
}

impl Attachment {
    fn of(folder: &Path, file: &Path) -> Result<Self, RecordsError> {
        let malformed = |source| RecordsError::Malformed { path: file.to_owned(), source };
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().replace(['-', '_'], " ");
        let shown = file.strip_prefix(folder).unwrap_or(file).display().to_string();
        let mut attachment = Self { title: stem, file: shown, image: None, table: None, more: 0 };
        let kind = match file.extension().and_then(|ending| ending.to_str()) {
            Some("csv") => {
                let mut reader = csv::ReaderBuilder::new()
                    .has_headers(false)
                    .flexible(true)
                    .from_path(file)
                    .map_err(malformed)?;
                let lines: Result<Vec<Vec<String>>, csv::Error> =
                    reader.records().map(|line| Ok(line?.iter().map(Into::into).collect())).collect();
                let mut lines = lines.map_err(malformed)?;
                attachment.more = lines.len().saturating_sub(LINES + 1);
                lines.truncate(LINES + 1);
                attachment.table = Some(lines);
                return Ok(attachment);
            }
            Some("svg") => "svg+xml",
            _ => "png",
        };
        let bytes = std::fs::read(file).map_err(|source| RecordsError::Io {
            path: file.to_owned(),
            source,
            remedy: "make it readable or remove it",
        })?;
        attachment.image = Some(format!("data:image/{kind};base64,{}", BASE64_STANDARD.encode(bytes)));
        Ok(attachment)
    }
}

fn name(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The files of a folder with an ending, by name; none where there is no such folder.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let mut found: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    found.retain(|file| file.is_file() && file.extension().is_some_and(|found| found == ending));
    found.sort();
    found
}
