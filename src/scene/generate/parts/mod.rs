//! The parts of generated scenes, and how a list of parts becomes a mesh.

mod figure;
mod frame;
pub mod furniture;
mod layout;
mod part;
mod random;

pub use frame::{Frame, sin_cos};
#[cfg(test)]
pub use layout::count;
pub use layout::{Layout, draw};
pub use part::{Draft, Shape};
pub use random::{Random, mix};
