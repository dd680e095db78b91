//! Clusters: [`aac`] and [`ploc`] merge them bottom-up to a binary tree, which is made wide: by [`widen`] from
//! the root down, by [`gathered`] a whole subtree at once. [`memory`] has the pipeline of both; [`in_order`] gives
//! clusters the form of an LBVH.

pub(crate) mod aac;
pub(crate) mod gathered;
pub(crate) mod in_order;
pub(crate) mod memory;
pub(crate) mod ploc;
pub(crate) mod widen;
