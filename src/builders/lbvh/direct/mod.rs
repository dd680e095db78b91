//! The builder `lbvh`: the tree of 4.7 as a wide tree, without refinement.

pub(crate) mod pipeline;
mod treelet;
