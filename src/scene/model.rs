//! A scene: a mesh, its cameras and its origin.

use super::one_line::{LONG, one_line};
use super::views::{View, views_around};
use crate::geometry::{Dropped, Mesh};
use std::path::Path;

/// What a scene file holds besides usable triangles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Contents {
    /// Objects and groups that became one mesh: `o` and `g` lines of OBJ, solids of STL, primitives of glTF in the
    /// places of their nodes; 1 in PLY, 0 in generated scenes.
    pub objects: usize,
    /// Points left out.
    pub points: usize,
    /// Lines left out: one for each element or primitive of them.
    pub lines: usize,
    /// Faces and primitives left out that have no whole triangle.
    pub empty: usize,
    /// Where the file has the first triangle that was dropped, in words: a line, a triangle from 0, or one of a
    /// primitive.
    pub first_dropped: Option<String>,
    /// What of the file was not applied, in words: of a file's reader without control characters, 160 characters each
    /// at most.
    pub remarks: Vec<String>,
}

impl Contents {
    /// One line for each thing left out.
    pub(super) fn told(&self) -> impl Iterator<Item = String> + '_ {
        let Self { points, lines, empty, .. } = self;
        let left_out = (points + lines + empty > 0).then(|| {
            format!(
                "left out as no triangles: {points} points, {lines} lines, {empty} without a whole triangle"
            )
        });
        left_out.into_iter().chain(self.remarks.iter().cloned())
    }
}

/// A scene ready to be built and rendered.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name in commands and records: the file's stem or the generator's name.
    pub name: String,
    /// The geometry.
    pub mesh: Mesh,
    /// Triangles left out, by reason.
    pub dropped: Dropped,
    /// What its file held besides.
    pub contents: Contents,
    /// At least one camera.
    pub views: Vec<View>,
    /// [`Mesh::fingerprint`] as 16 hex digits, which identifies the geometry.
    pub sha: String,
    /// "file PATH" or "generated, seed N".
    pub source: String,
}

impl Scene {
    /// A scene of `mesh`, with the hash computed and, if `views` is empty, cameras around the geometry.
    pub fn new(name: String, mesh: Mesh, dropped: Dropped, views: Vec<View>, source: String) -> Self {
        let views = if views.is_empty() { views_around(&mesh) } else { views };
        let sha = format!("{:016x}", mesh.fingerprint());
        Self { name, mesh, dropped, contents: Contents::default(), views, sha, source }
    }

    /// What of its file is not in the mesh, a line each; nothing where all is.
    pub fn remarks(&self) -> Vec<String> {
        let dropped = (self.dropped.total() > 0).then(|| {
            let place = self.contents.first_dropped.as_ref();
            let first = place.map_or_else(String::new, |place| format!(", first: {place}"));
            format!("{}{first}; export the file again", self.dropped)
        });
        // A name may hold a line's end.
        let called = self.called();
        let told = dropped.into_iter().chain(self.contents.told());
        told.map(|line| one_line(&format!("{called}: {line}"), LONG)).collect()
    }

    /// The name of the scene's file, with its ending and without its folder; of other scenes their own.
    fn called(&self) -> &str {
        let file = self.source.strip_prefix("file ").and_then(|path| Path::new(path).file_name()?.to_str());
        file.unwrap_or(&self.name)
    }
}
