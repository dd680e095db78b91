//! The wide tree that builders emit, its limits, its costs and its validation.

mod block;
mod epo;
mod id_block;
pub(crate) mod limits;
mod link;
mod links;
mod record;
pub mod saved;
mod statistics;
mod upload;
mod validate;
mod vectors;
mod wide;

pub use block::TriangleBlock;
pub(crate) use block::transposed;
pub use epo::epo;
pub use id_block::{IdBlock, LeafBlock};
pub use limits::{MAX_DEPTH, MAX_LEAF_BLOCKS};
pub use link::{Child, Link};
pub use statistics::{Statistics, sah_cost};
pub use validate::Invalid;
pub use wide::{Bvh4, Bvh8, WideBvh, WideNode};
