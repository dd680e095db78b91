//! A scene: a mesh, its cameras and its origin.

use super::fingerprint;
use super::views::{View, views_around};
use crate::geometry::{Dropped, Mesh};

/// A scene ready to be built and rendered.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name in commands and records: the file's stem or the generator's name.
    pub name: String,
    /// The geometry.
    pub mesh: Mesh,
    /// Triangles left out, by reason.
    pub dropped: Dropped,
    /// At least one camera.
    pub views: Vec<View>,
    /// 16 hex digits of a hash of the mesh (vertices and triangles), which identifies the geometry.
    pub sha: String,
    /// "file PATH" or "generated, seed N".
    pub source: String,
}

impl Scene {
    /// A scene of `mesh`, with the hash computed and, if `views` is empty, cameras around the geometry.
    pub fn new(name: String, mesh: Mesh, dropped: Dropped, views: Vec<View>, source: String) -> Self {
        let views = if views.is_empty() { views_around(&mesh) } else { views };
        let sha = fingerprint::of(&mesh);
        Self { name, mesh, dropped, views, sha, source }
    }
}
