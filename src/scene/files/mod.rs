//! Scene files: PLY, OBJ, STL, glTF and GLB, plain or compressed.
//!
//! [`load()`] opens a file ([`source`]), hands it to the reader of its format and makes a scene of the [`raw_mesh`]
//! that comes back. What a file may cost is bounded while it is read ([`guard`]).

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod cameras;
mod error;
mod gltf;
mod guard;
mod lines;
mod load;
mod obj;
mod ply;
mod ply_header;
mod ply_rows;
mod raw_mesh;
mod source;
mod stl;

pub use error::SceneError;
pub use guard::Limits;
pub use load::{load, load_within, stem};
