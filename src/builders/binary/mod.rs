//! Binary trees: the auxiliary BVH, and the subtrees split near the leaves.

pub(crate) mod kind;
pub(crate) mod node;
pub(crate) mod subtrees;
pub(crate) mod tagged;
pub(crate) mod tree;
