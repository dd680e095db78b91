//! Scenes: a mesh, its cameras and its origin.
//!
//! A scene is read from a file (`load`, with the feature `files`) or made by a [`Generator`]. [`paper`] lists
//! the paper's nine scenes, which are hard to obtain, and their generated stand-ins.

mod catalog;
#[cfg(feature = "files")]
mod error;
mod fingerprint;
mod generate;
#[cfg(feature = "files")]
mod load;
mod model;
#[cfg(feature = "files")]
mod obj;
#[cfg(feature = "files")]
mod ply;
#[cfg(feature = "files")]
mod ply_rows;
#[cfg(feature = "files")]
mod raw_mesh;
mod views;

pub use catalog::{PaperScene, paper, paper_scene_in};
#[cfg(feature = "files")]
pub use error::SceneError;
pub use generate::{Generator, builtin, generator, generators, scalable, scalable_name, scalable_triangles};
#[cfg(feature = "files")]
pub use load::load;
pub use model::Scene;
pub use views::{InvalidView, View, views_around};
