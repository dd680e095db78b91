//! The spatial split of a cut, by the fastest way for its length (paper 4.4). All ways find the same split.

pub(crate) mod bins;
#[cfg(test)]
mod cases;
pub(crate) mod lanes;
pub(crate) mod plane_sweep;
pub(crate) mod split;
pub(crate) mod strategy;
