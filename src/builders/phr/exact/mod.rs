//! Shortcuts to the same tree: where the recursion over cuts has nothing to decide.
//!
//! * [`single_node`]: below a cut of a single node the splits are those of the auxiliary BVH;
//! * [`leaf_cuts`]: a cut of leaves alone has nothing to refine.

pub(crate) mod leaf_cuts;
pub(crate) mod single_node;
