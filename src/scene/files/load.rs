//! Scenes from files: the format by the name, the mesh checked, cameras beside it.

use super::error::{Fault, SHORT, SceneError};
use super::guard::{Guard, Limits};
use super::source::{Compression, reader};
use super::{cameras, gltf, obj, ply, stl};
use crate::geometry::Mesh;
use crate::scene::model::{Contents, Scene};
use crate::scene::one_line::one_line;
use crate::scene::views;
use std::path::Path;

#[derive(Clone, Copy)]
enum Format {
    Ply,
    Obj,
    Stl,
    Gltf,
    Glb,
}

const FORMATS: [(&str, Format); 5] = [
    (".ply", Format::Ply),
    (".obj", Format::Obj),
    (".stl", Format::Stl),
    (".gltf", Format::Gltf),
    (".glb", Format::Glb),
];

/// Loads `path` with as much memory as the machine has to give: see [`load_within`].
///
/// # Errors
/// [`SceneError`], one line each.
pub fn load(path: impl AsRef<Path>) -> Result<Scene, SceneError> {
    read(path.as_ref(), &Limits::of_machine())
}

/// Loads `path`: PLY (binary or ASCII), OBJ, STL (binary or ASCII), glTF 2 or GLB, each with `.gz` or `.zst` after it.
/// Polygons become fans from their first corner (of concave ones, triangles may lie outside), strips triangles, the
/// instances of a glTF scene copies in the places of their nodes.
///
/// Triangles have the order of the file, and so have vertices, but for OBJ: its vertices are numbered in the order in
/// which faces use them first, and those that no face uses are left out. Vertices of glTF stand by accessor, once for
/// each place of a mesh; in STL every triangle has three of its own.
///
/// Faces of OBJ name vertices given before them; later ones are out of range. Triangles that no builder accepts are
/// dropped and counted in [`Scene::dropped`], what is no triangle in [`Scene::contents`]. Cameras come from
/// `views.json` beside the file, or are placed around the geometry where it has none for this scene; those of glTF
/// are not applied, which is remarked. Coordinates stay as they are; up is y in glTF, in other files as
/// [`views_around`](crate::scene::views_around) takes it.
///
/// # Errors
/// [`SceneError`], one line each. A file whose mesh would exceed `limits` is refused, before its memory is taken where
/// the file declares its size.
pub fn load_within(path: impl AsRef<Path>, limits: &Limits) -> Result<Scene, SceneError> {
    read(path.as_ref(), limits)
}

fn read(path: &Path, limits: &Limits) -> Result<Scene, SceneError> {
    let guard = Guard::new(limits);
    let is_folder = std::fs::metadata(path).is_ok_and(|metadata| metadata.is_dir());
    let format = format_of(path).filter(|_| !is_folder);
    let (name, format, compression) = match format {
        Some(format) => format,
        // A folder or a missing file is that first.
        None => {
            super::source::open(path)?;
            return Err(SceneError::UnknownFormat(path.to_owned()));
        }
    };
    let mut reader = reader(path, compression, &guard)?;
    let raw = match format {
        Format::Ply => ply::read(&mut *reader, &guard),
        Format::Obj => obj::read(&mut *reader, &guard),
        Format::Stl => stl::read(&mut *reader, &guard),
        Format::Gltf => gltf::read_json(&mut *reader, path, &guard),
        Format::Glb => gltf::read_binary(&mut *reader, path, &guard),
    }
    .map_err(|fault: Fault| guard.reason().unwrap_or(fault).in_file(path))?;
    drop(reader);

    let unusable = |source| SceneError::Unusable { path: path.to_owned(), source };
    let given = raw.triangles.len() + raw.out_of_range;
    let (mesh, mut dropped, first) = Mesh::sifted(raw.vertices, raw.triangles, None).map_err(unusable)?;
    dropped.out_of_range += raw.out_of_range;
    // What a reader has seen says more than a number.
    let first = raw.first_out_of_range.or_else(|| first.map(|triangle| format!("triangle {triangle}")));
    // A remark may quote the file.
    let remarks = raw.contents.remarks.iter().map(|remark| one_line(remark, SHORT)).collect();
    let mut contents = Contents { first_dropped: first, remarks, ..raw.contents };
    if mesh.is_empty() {
        let (path, remarks) = (path.to_owned(), contents.told().collect());
        return Err(SceneError::Empty {
            path,
            given,
            dropped,
            first_dropped: contents.first_dropped,
            remarks,
        });
    }
    let mut views = cameras::beside(path, &name, &mut contents.remarks)?;
    if views.is_empty() {
        if raw.cameras > 0 {
            let remark =
                format!("{} cameras of the file are not applied, give theirs in views.json", raw.cameras);
            contents.remarks.push(remark);
        }
        views = views::around(&mesh, raw.up);
    }
    let scene = Scene::new(name, mesh, dropped, views, format!("file {}", path.display()));
    Ok(Scene { contents, ..scene })
}

/// The name of a scene file without its endings; `None` where they name no format.
pub fn stem(path: &Path) -> Option<String> {
    format_of(path).map(|(stem, ..)| stem)
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
    let (stem, format) = FORMATS
        .iter()
        .find_map(|(suffix, format)| without_suffix(name, suffix).map(|stem| (stem, *format)))?;
    Some((stem.to_owned(), format, compression))
}

/// `name` without `suffix` in any case of letters.
fn without_suffix<'a>(name: &'a str, suffix: &str) -> Option<&'a str> {
    let at = name.len().checked_sub(suffix.len())?;
    let (stem, end) = name.split_at_checked(at)?;
    (!stem.is_empty() && end.eq_ignore_ascii_case(suffix)).then_some(stem)
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
        assert_eq!(stem("x.Stl.gz").as_deref(), Some("x"));
        assert_eq!(stem("x.GLB").as_deref(), Some("x"));
        for bad in ["kitchen", "kitchen.fbx", "kitchen.zst", ".ply", "kitchen.ply.xz", "ä", ""] {
            assert_eq!(stem(bad), None, "{bad}");
        }
    }
}
