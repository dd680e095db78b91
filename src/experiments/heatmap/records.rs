//! What a heat map is drawn from: a CSV with a line per builder, and beside it the counts of all pixels as a grey
//! PNG of 16 bits, one builder below the other, without loss.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use crate::bench::files::{RecordsError, content, read_csv_file, write_csv, write_whole};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Pixels across and down, at most.
pub const MOST_PIXELS: u32 = 1 << 12;
/// Panels, at most.
const MOST_PANELS: usize = 256;

/// A line of the CSV. A step is the visit of an inner node or the test of a leaf block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeatmapRow {
    /// Revision of this program, `-dirty` if the sources differed from it.
    pub git_rev: String,
    /// Processor model.
    pub cpu: String,
    /// Scene name.
    pub scene: String,
    /// Triangles of the scene.
    pub triangles: u64,
    /// View, from 0.
    pub view: u32,
    /// Pixels across and down.
    pub size: u32,
    /// Builder name.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// Threads that built.
    pub threads: u32,
    /// Median time of the fresh builds, ms.
    pub build_ms: f64,
    /// Mean steps of a primary ray.
    pub steps_mean: f64,
    /// 95 of 100 rays take at most so many.
    pub steps_p95: u32,
    /// 99 of 100 rays take at most so many.
    pub steps_p99: u32,
    /// The most.
    pub steps_max: u32,
    /// Steps of the brightest colour; more have the same.
    pub scale: u32,
}

/// One builder's part of a heat map.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// The line of the CSV.
    pub row: HeatmapRow,
    /// Steps of each pixel, rows from the top.
    pub steps: Vec<u16>,
}

/// Why the records of a heat map cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum HeatmapError {
    /// The CSV cannot be read or written.
    #[error(transparent)]
    Records(#[from] RecordsError),
    /// The counts cannot be read, or are not those of the CSV.
    #[error("{}: {reason}; run `phr heatmap` again without --redraw", path.display())]
    Counts {
        /// The file of counts.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

/// The CSV and the counts that belong to the picture `png`.
pub fn places(png: &Path) -> [PathBuf; 2] {
    [png.with_extension("csv"), png.with_extension("counts.png")]
}

/// Writes the records beside the picture `png`.
///
/// # Errors
/// An unwritable place.
pub fn write(png: &Path, panels: &[Panel]) -> Result<(), HeatmapError> {
    let [csv_path, counts_path] = places(png);
    let rows: Vec<&HeatmapRow> = panels.iter().map(|panel| &panel.row).collect();
    write_csv(&csv_path, &rows)?;
    let counts = encoded(panels)
        .map_err(|error| HeatmapError::Counts { path: counts_path.clone(), reason: error.to_string() })?;
    Ok(write_whole(&counts_path, &counts)?)
}

fn encoded(panels: &[Panel]) -> Result<Vec<u8>, png::EncodingError> {
    let size = panels.first().map_or(0, |panel| panel.row.size);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size, size * panels.len() as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header()?;
    let samples: Vec<u8> =
        panels.iter().flat_map(|panel| &panel.steps).flat_map(|n| n.to_be_bytes()).collect();
    writer.write_image_data(&samples)?;
    writer.finish()?;
    Ok(bytes)
}

/// Reads the records beside the picture `png`.
///
/// # Errors
/// Missing or malformed files, and counts of other sizes than the CSV tells.
pub fn read(png: &Path) -> Result<Vec<Panel>, HeatmapError> {
    let [csv_path, counts_path] = places(png);
    let rows: Vec<HeatmapRow> = read_csv_file(&csv_path, "run `phr heatmap` without --redraw first")?;
    let size = rows.first().map_or(0, |row| row.size);
    let failed = |reason: String| HeatmapError::Counts { path: counts_path.clone(), reason };
    let (count, are_alike) = (rows.len(), rows.iter().all(|row| row.size == size));
    if !(1..=MOST_PIXELS).contains(&size) || count > MOST_PANELS {
        return Err(failed(format!(
            "{count} panels of {size} x {size} pixels; a heat map has at most {MOST_PANELS} of {MOST_PIXELS} x {MOST_PIXELS}"
        )));
    }
    let samples = decoded(&counts_path, |across, down| {
        let panels = u64::from(size).checked_mul(count as u64);
        (are_alike && across == size && Some(u64::from(down)) == panels)
            .then_some(())
            .ok_or_else(|| format!("{across} x {down} pixels are not {count} panels of {size} x {size}"))
    });
    let samples = samples.map_err(failed)?;
    // No more than the picture has.
    let pixels = (size as usize).saturating_mul(size as usize).max(1);
    let panels = rows.into_iter().zip(samples.chunks_exact(pixels));
    Ok(panels.map(|(row, steps)| Panel { row, steps: steps.to_vec() }).collect())
}

/// Samples of a grey PNG of 16 bits, of a width and height that `check` accepts: memory is taken afterwards.
fn decoded(path: &Path, check: impl Fn(u32, u32) -> Result<(), String>) -> Result<Vec<u16>, String> {
    let file = content(path).map_err(|error| error.to_string())?;
    let mut reader =
        png::Decoder::new(std::io::Cursor::new(file)).read_info().map_err(|error| error.to_string())?;
    if reader.output_color_type() != (png::ColorType::Grayscale, png::BitDepth::Sixteen) {
        return Err("not a grey picture of 16 bits".into());
    }
    let (across, down) = reader.info().size();
    check(across, down)?;
    let (mut bytes, size) = (Vec::new(), reader.output_buffer_size().ok_or("too large")?);
    bytes.try_reserve_exact(size).map_err(|_| format!("no memory for its {size} bytes"))?;
    bytes.resize(size, 0);
    reader.next_frame(&mut bytes).map_err(|error| error.to_string())?;
    Ok(bytes.as_chunks().0.iter().map(|pair| u16::from_be_bytes(*pair)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(builder: &str, size: u32) -> Panel {
        let steps: Vec<u16> = (0..size * size).map(|i| (i * 77 % 1031) as u16).collect();
        let row = HeatmapRow {
            git_rev: "1234".into(),
            cpu: "a".into(),
            scene: "s".into(),
            triangles: 10,
            view: 0,
            size,
            builder: builder.into(),
            width: 4,
            threads: 2,
            build_ms: 1.25,
            steps_mean: 3.5,
            steps_p95: 9,
            steps_p99: 10,
            steps_max: 12,
            scale: 10,
        };
        Panel { row, steps }
    }

    #[test]
    fn records_read_back_and_others_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let png = folder.path().join("map.png");
        let panels = [panel("a", 8), panel("b", 8)];
        write(&png, &panels).unwrap();
        assert_eq!(read(&png).unwrap(), panels);

        write(&folder.path().join("other.png"), &[panel("a", 4)]).unwrap();
        let [_, counts] = places(&png);
        std::fs::copy(folder.path().join("other.counts.png"), counts).unwrap();
        let error = read(&png).unwrap_err().to_string();
        assert!(error.contains("map.counts.png: 4 x 4 pixels are not 2 panels of 8 x 8"), "{error}");
        // More pixels than any heat map has, and a file that might never end.
        let [csv, counts] = places(&png);
        let text = std::fs::read_to_string(&csv).unwrap();
        std::fs::write(&csv, text.replace(",8,a,", ",1000000,a,").replace(",8,b,", ",1000000,b,")).unwrap();
        let error = read(&png).unwrap_err().to_string();
        assert!(error.contains("1000000 x 1000000 pixels"), "{error}");
        std::fs::write(&csv, text).unwrap();
        std::fs::remove_file(&counts).unwrap();
        std::fs::create_dir(&counts).unwrap();
        assert!(read(&png).unwrap_err().to_string().contains("not a regular file"));
        std::fs::remove_file(folder.path().join("map.csv")).unwrap();
        assert!(matches!(read(&png), Err(HeatmapError::Records(RecordsError::Io { .. }))));
    }
}
