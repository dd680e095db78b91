//! Binary trees: the auxiliary BVH, and the subtrees split near the leaves.

pub(crate) mod kind;
pub(crate) mod node;
mod refit;
pub(crate) mod subtrees;
pub(crate) mod tagged;
pub(crate) mod tree;
