//! The object split of a cut, by the fastest way for its length (paper 4.2). All ways find the same split.

pub(crate) mod bins;
#[cfg(test)]
mod cases;
pub(crate) mod full_sweep;
pub(crate) mod lanes;
pub(crate) mod ranks;
pub(crate) mod split;
pub(crate) mod strategy;
