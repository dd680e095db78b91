//! The tree of 4.7 as a wide tree: the builder `lbvh`, without refinement, and, for cuts over them, [`clusters`].

mod cluster_treelet;
pub(crate) mod clusters;
mod full_leaves;
pub(crate) mod pipeline;
mod treelet;
