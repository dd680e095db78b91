//! Binary trees of clusters, as AAC and PLOC make them, to wide ones: [`collapse`] from the root down, [`emit`] a whole
//! subtree at once.

pub(crate) mod collapse;
pub(crate) mod emit;
