//! Wide trees (paper 4.5, 4.6).

pub(crate) mod branchless;
pub(crate) mod largest_first;
pub(crate) mod top_down;
pub(crate) mod treelet;
