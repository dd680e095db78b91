//! Approximate agglomerative clustering (Gu, He, Fatahalian, Blelloch 2013): Morton order partitions the triangles
//! top-down, and clusters are merged bottom-up, at each step only down to f(n) of them. The binary tree is then widened
//! by [`crate::builders::clusters`].

pub(crate) mod clustering;
pub(crate) mod config;
pub(crate) mod pipeline;
