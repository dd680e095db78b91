//! Scenes from files: PLY or OBJ, plain or compressed.

use super::error::{Fault, SceneError};
use super::model::Scene;
use super::{obj, ply, views};
use crate::geometry::Mesh;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

#[derive(Clone, Copy)]
enum Format {
    Ply,
    Obj,
}

#[derive(Clone, Copy)]
enum Compression {
    None,
    Gzip,
    Zstd,
}

/// Buffer between file or decoder and parser, bytes.
const BUFFER: usize = 1 << 20;
/// Windows up to 2^27 bytes (`zstd --long`) are accepted.
const ZSTD_WINDOW_LOG: u32 = 27;

/// Loads `path`: PLY (binary or ASCII) or OBJ, either with `.gz` or `.zst` after it. Polygons become fans of
/// triangles. Triangles that no builder accepts are dropped and counted in [`Scene::dropped`]. Cameras come
/// from `views.json` beside the file, or are placed around the geometry where it has none for this scene.
///
/// # Errors
/// [`SceneError`], one line each.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    let unreadable = |source| SceneError::Unreadable { path: path.to_owned(), source };
    if std::fs::metadata(path).map_err(unreadable)?.is_dir() {
        return Err(SceneError::Directory(path.to_owned()));
    }
    let (name, format, compression) =
        format_of(path).ok_or_else(|| SceneError::UnknownFormat(path.to_owned()))?;
    let file = File::open(path).map_err(unreadable)?;
    let mut reader = decompressed(file, compression).map_err(unreadable)?;
    let raw = match format {
        Format::Ply => ply::read(&mut reader),
        Format::Obj => obj::read(&mut reader),
    }
    .map_err(|fault: Fault| fault.in_file(path))?;

    let (mesh, mut dropped) = Mesh::new_non_empty(raw.vertices, raw.triangles)
        .map_err(|source| SceneError::Unusable { path: path.to_owned(), source })?;
    dropped.out_of_range += raw.out_of_range;
    let views = views::beside(path, &name)?;
    Ok(Scene::new(name, mesh, dropped, views, format!("file {}", path.display())))
}

/// Stem, format and compression by the file's name.
fn format_of(path: &Path) -> Option<(String, Format, Compression)> {
    let name = path.file_name()?.to_string_lossy();
    let (name, compression) = if let Some(name) = without_suffix(&name, ".gz") {
        (name, Compression::Gzip)
    } else if let Some(name) = without_suffix(&name, ".zst") {
        (name, Compression::Zstd)
    } else {
        (&*name, Compression::None)
    };
    let (stem, format) = without_suffix(name, ".ply")
        .map(|stem| (stem, Format::Ply))
        .or_else(|| without_suffix(name, ".obj").map(|stem| (stem, Format::Obj)))?;
    Some((stem.to_owned(), format, compression))
}

/// `name` without `suffix` in any case of letters.
fn without_suffix<'a>(name: &'a str, suffix: &str) -> Option<&'a str> {
    let at = name.len().checked_sub(suffix.len())?;
    (name.is_char_boundary(at) && at > 0 && name[at..].eq_ignore_ascii_case(suffix)).then(|| &name[..at])
}

fn decompressed(file: File, compression: Compression) -> io::Result<Box<dyn BufRead>> {
    fn buffered(reader: impl Read + 'static) -> Box<dyn BufRead> {
        Box::new(BufReader::with_capacity(BUFFER, reader))
    }
    Ok(match compression {
        Compression::None => buffered(file),
        Compression::Gzip => {
            buffered(flate2::bufread::MultiGzDecoder::new(BufReader::with_capacity(BUFFER, file)))
        }
        Compression::Zstd => {
            let mut decoder = zstd::Decoder::new(file)?;
            decoder.window_log_max(ZSTD_WINDOW_LOG)?;
            buffered(decoder)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_the_format() {
        let stem = |name: &str| format_of(Path::new(name)).map(|(stem, ..)| stem);
        assert_eq!(stem("a/kitchen.ply.zst").as_deref(), Some("kitchen"));
        assert_eq!(stem("San.Miguel.OBJ.GZ").as_deref(), Some("San.Miguel"));
        assert_eq!(stem("x.ply").as_deref(), Some("x"));
        for bad in ["kitchen", "kitchen.stl", "kitchen.zst", ".ply", "kitchen.ply.xz", "ä", ""] {
            assert_eq!(stem(bad), None, "{bad}");
        }
    }
}
