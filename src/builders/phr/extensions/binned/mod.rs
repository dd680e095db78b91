//! Binned SAH from the root down (Wald 2007), as an auxiliary tree (paper 5.5): centroids are counted in bins along
//! each axis, and the planes between bins are compared by the surface area heuristic.

mod bins;
pub(crate) mod config;
pub(crate) mod tree;
