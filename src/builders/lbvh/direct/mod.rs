//! The builder `lbvh`: the tree of 4.7 as a wide tree, without refinement.

mod pipeline;
mod treelet;

pub use pipeline::Lbvh;
