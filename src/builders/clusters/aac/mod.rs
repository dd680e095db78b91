//! Approximate agglomerative clustering (Gu, He, Fatahalian, Blelloch 2013): Morton order partitions the triangles
//! top-down, and clusters are merged bottom-up, at each step only down to f(n) of them. The binary tree is then widened
//! by [`crate::builders::clusters`]. Two changes: codes have 32 bits for any scene, and runs of one code are
//! partitioned at the middle of their centroids.

pub(crate) mod clustering;
pub(crate) mod config;
pub(crate) mod pipeline;
