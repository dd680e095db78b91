//! Scenes: a mesh, its cameras and its origin.
//!
//! A scene is read from a file (`load`, with the feature `files`) or made by a [`Generator`]. [`paper`] lists
//! the paper's nine scenes, which are hard to obtain, and their generated stand-ins.

mod catalog;
#[cfg(feature = "files")]
mod files;
mod generate;
mod model;
mod one_line;
mod views;

pub use catalog::{PaperScene, paper, paper_scene_in};
#[cfg(feature = "files")]
pub use files::{Limits, SceneError, load, load_within, stem};
pub use generate::{Animated, Animation, animated, animated_by_name};
pub use generate::{Generator, builtin, generator, generators, scalable, scalable_name, scalable_triangles};
pub use model::{Contents, Scene};
pub use views::{InvalidView, View, views_around};
