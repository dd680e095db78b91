//! Binary trees of clusters, as AAC and PLOC make them, to wide ones: [`collapse`] from the root down, [`emit`] a whole
//! subtree at once. [`in_order`] gives them the form of an LBVH.

pub(crate) mod collapse;
pub(crate) mod emit;
pub(crate) mod in_order;
