//! Pictures and tables that lie in a results folder beside the rows, or in other folders: heat maps, experiments
//! and other figures.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]

use crate::bench::files::{content, last_line, text, without_last_line};
use crate::bench::phases::PHASES;
use crate::bench::rounds::ROUNDS;
use crate::bench::row::ROWS;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;
use std::error::Error;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Lines of a table that the page shows; the file has all.
const LINES: usize = 200;
/// Subfolders of heat maps and of experiments.
const HEAT_MAPS: [&str; 2] = ["heatmaps", "heatmap"];
const EXPERIMENTS: &str = "experiments";
/// Records of a run below an experiment: its figures and findings say what is in them.
const RECORDS: [&str; 3] = [ROWS, ROUNDS, PHASES];
/// The steps of every pixel of a heat map, which is no picture.
const COUNTS: &str = ".counts.png";

/// A picture, a table or a text.
#[derive(Debug, Default, Serialize)]
pub struct Attachment {
    /// Name of the file without its ending, as words, after that of the experiment.
    pub title: String,
    /// The file, relative to the folder.
    pub file: String,
    /// The picture as a data URI.
    image: Option<String>,
    /// The table: header and lines.
    table: Option<Vec<Vec<String>>>,
    /// Lines of the table that are not shown.
    more: usize,
    /// The text of findings, or why the file is not shown.
    text: Option<String>,
}

/// What lies in a folder.
#[derive(Debug, Default, Serialize)]
pub struct Attachments {
    /// PNG files whose name begins with `heat`, or in a folder `heatmaps`.
    pub heat_maps: Vec<Attachment>,
    /// SVG and CSV files and findings in the folder `experiments`, and in folders in it, one for an experiment.
    pub experiments: Vec<Attachment>,
    /// Other SVG files, but for Figure 6, which the page draws itself, and heat maps that cannot be read.
    pub figures: Vec<Attachment>,
}

impl Attachments {
    /// Those of `folder`, and heat maps and experiments of the folders `others`; one that cannot be read says so,
    /// and costs the page no other.
    pub fn of(folder: &Path, others: &[PathBuf]) -> Self {
        let mut figures = files(folder, "svg");
        figures.retain(|file| !name(file).starts_with("figure6"));
        let figures = figures.iter().map(|file| Attachment::of(folder, file)).collect();
        let mut found = Self { figures, ..Self::default() };
        found.add(folder, &folder.join(EXPERIMENTS));
        others.iter().for_each(|other| found.add(other, other));
        found
    }

    /// Adds the heat maps of a folder and what lies in one of experiments.
    fn add(&mut self, folder: &Path, experiments: &Path) {
        let is_heat = |file: &PathBuf| name(file).starts_with("heat");
        let heat_maps = files(folder, "png").into_iter().filter(is_heat);
        let below = HEAT_MAPS.iter().flat_map(|below| files(&folder.join(below), "png"));
        let all_maps = heat_maps.chain(below).filter(|file| !name(file).ends_with(COUNTS));
        let read = |file: PathBuf| Attachment::of(folder, &file);
        let (heat_maps, unread): (Vec<_>, Vec<_>) = all_maps.map(read).partition(|map| map.image.is_some());
        self.heat_maps.extend(heat_maps);
        self.figures.extend(unread);
        let below = folders(experiments).into_iter().filter(|folder| !HEAT_MAPS.contains(&&*name(folder)));
        let all = std::iter::once(experiments.to_owned()).chain(below);
        let mut of_experiments: Vec<PathBuf> = all.flat_map(|folder| in_order(&folder)).collect();
        of_experiments.retain(|file| !RECORDS.contains(&name(file).as_str()) && !is_heat(file));
        self.experiments.extend(of_experiments.into_iter().map(read));
    }
}

impl Attachment {
    fn of(folder: &Path, file: &Path) -> Self {
        let shown = file.strip_prefix(folder).unwrap_or(file).display().to_string();
        let mut attachment = Self { title: title(folder, file), file: shown, ..Self::default() };
        if let Err(error) = attachment.read(file) {
            attachment.title += ", not shown";
            attachment.text = Some(format!("{}: {error}; correct or remove it", attachment.file));
        }
        attachment
    }

    fn read(&mut self, file: &Path) -> Result<(), Box<dyn Error>> {
        match file.extension().and_then(|ending| ending.to_str()) {
            Some("csv") => {
                let bytes = content(file)?;
                let (above, written) = without_last_line(&bytes);
                let mut reader =
                    csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(above);
                let lines: Result<Vec<Vec<String>>, csv::Error> =
                    reader.records().map(|line| Ok(line?.iter().map(Into::into).collect())).collect();
                let mut lines = lines?;
                let found = lines.len().saturating_sub(1);
                if written != Some(found) {
                    let wanted = last_line(found);
                    let wanted = wanted.trim_end();
                    return Err(
                        format!("{found} rows, but not the last line `{wanted}`: it may be cut").into()
                    );
                }
                self.more = lines.len().saturating_sub(LINES + 1);
                lines.truncate(LINES + 1);
                self.table = Some(lines);
            }
            Some("md") => self.text = Some(text(file)?),
            ending => {
                let kind = if ending == Some("svg") { "svg+xml" } else { "png" };
                let bytes = BASE64_STANDARD.encode(content(file)?);
                self.image = Some(format!("data:image/{kind};base64,{bytes}"));
            }
        }
        Ok(())
    }
}

fn name(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// What a file of a results folder is called: `grid: effects` of `experiments/grid/effects.svg` or `grid/effects.svg`.
fn title(folder: &Path, file: &Path) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let below = file.strip_prefix(folder).ok().and_then(Path::parent).and_then(Path::file_name);
    let is_experiment = |name: &OsStr| name != EXPERIMENTS && !HEAT_MAPS.iter().any(|maps| name == *maps);
    let experiment = below.filter(|name| is_experiment(name)).map(|name| name.to_string_lossy());
    let experiment = experiment.filter(|name| *name != stem);
    let title = experiment.map_or_else(|| stem.to_string(), |name| format!("{name}: {stem}"));
    title.replace(['-', '_'], " ")
}

/// Findings, pictures and tables of a folder: texts first, then by name, a picture before its figures.
fn in_order(folder: &Path) -> Vec<PathBuf> {
    let endings = ["md", "svg", "csv"];
    let mut found: Vec<PathBuf> = endings.iter().flat_map(|ending| files(folder, ending)).collect();
    let is_text = |file: &PathBuf| file.extension().is_some_and(|ending| ending == "md");
    found.sort_by(|a, b| {
        let by_name = || a.file_stem().cmp(&b.file_stem()).then(b.extension().cmp(&a.extension()));
        is_text(b).cmp(&is_text(a)).then_with(by_name)
    });
    found
}

/// The folders in a folder, by name; none where there is no such folder.
fn folders(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let mut found: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    found.sort();
    found
}

/// The files of a folder with an ending, by name; none where there is no such folder.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let mut found: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    found.retain(|file| file.is_file() && file.extension().is_some_and(|found| found == ending));
    found.sort();
    found
}
