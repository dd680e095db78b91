//! The wide tree (paper 4.5) and its parallel construction (4.6).
//!
//! * [`open_largest`]: the rule of 4.5, by its definition;
//! * [`top_down`]: what a builder supplies to be built top-down; [`build`]: the recursion over wide nodes;
//! * [`parallel`]: 4.6, the recursion divided into tasks; [`ahead`]: what is too large for a task, split in parallel;
//! * [`treelet`]: the nodes and leaf blocks that one task makes;
//! * [`binary_source`]: subtrees all of whose binary splits are known, widened at once;
//! * [`branchless`]: the same for whole LBVH treelets, small subtrees whole, without a branch that depends on the tree;
//! * [`optimal`]: the cheapest wide tree over a binary one, by dynamic programming;
//! * [`foreign`]: trees that were made elsewhere, widened;
//! * [`refit`]: wide trees fitted to a mesh that has moved.

pub(crate) mod ahead;
pub(crate) mod binary_source;
pub(crate) mod branchless;
pub(crate) mod build;
pub(crate) mod foreign;
pub(crate) mod memory;
pub(crate) mod open_largest;
pub(crate) mod optimal;
pub(crate) mod parallel;
pub(crate) mod refit;
pub(crate) mod top_down;
pub(crate) mod treelet;
