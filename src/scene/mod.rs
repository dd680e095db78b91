//! Scenes: a mesh, its cameras and where it came from.

use crate::geometry::{Dropped, Mesh};
use glam::Vec3;

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct View {
    /// Position, scene units.
    pub eye: Vec3,
    /// Point looked at.
    pub target: Vec3,
    /// Up direction, not parallel to the line of sight.
    pub up: Vec3,
    /// Vertical field of view, degrees.
    pub fov_y_deg: f32,
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
    /// At least one camera.
    pub views: Vec<View>,
    /// First 16 hex digits of a hash of the mesh (vertices and triangles), which names the very geometry.
    pub sha: String,
    /// "file PATH" or "generated, seed N".
    pub source: String,
}
