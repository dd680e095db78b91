//! Shortcuts to the same tree.

pub(crate) mod leaf_cuts;
pub(crate) mod single_node;
