//! Clusters: [`aac`] and [`ploc`] merge them bottom-up to a binary tree, which is made wide: by [`collapse`] from the root
//! down, by [`emit`] a whole subtree at once. [`in_order`] gives them the form of an LBVH.

pub(crate) mod aac;
pub(crate) mod collapse;
pub(crate) mod emit;
pub(crate) mod in_order;
pub(crate) mod ploc;
