//! Scenes: a mesh, its cameras and where it came from.
//!
//! A scene is read from a file (`load`, with the feature `files`) or made by a [`Generator`]. [`paper`] lists
//! the nine scenes of the paper, whose files few people have, and the generated stand-ins for them.

mod catalog;
#[cfg(feature = "files")]
mod error;
mod fingerprint;
mod generate;
#[cfg(feature = "files")]
mod load;
#[cfg(feature = "files")]
mod obj;
#[cfg(feature = "files")]
mod ply;
#[cfg(feature = "files")]
mod ply_rows;
mod views;

pub use catalog::{PaperScene, paper, paper_scene_in};
#[cfg(feature = "files")]
pub use error::SceneError;
pub use generate::{Generator, builtin, generator, generators, scalable, scalable_name, scalable_triangles};
#[cfg(feature = "files")]
pub use load::load;
pub use views::{InvalidView, View, views_around};

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
    /// 16 hex digits of a hash of the mesh (vertices and triangles), which names the very geometry.
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
