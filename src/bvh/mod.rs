//! The wide tree every builder emits, what it costs, and the proof that it is whole.

mod clip;
mod epo;
pub(crate) mod limits;
mod statistics;
mod validate;
mod wide;

pub(crate) use clip::Polygon;
pub use epo::epo;
pub use limits::{MAX_DEPTH, MAX_LEAF_BLOCKS};
pub use statistics::{Statistics, sah_cost};
pub use validate::Invalid;
pub use wide::{Bvh4, Bvh8, Child, Link, TriangleBlock, WideBvh, WideNode};
