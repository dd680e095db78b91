//! Approximate agglomerative clustering (Gu, He, Fatahalian, Blelloch 2013): Morton order partitions the triangles
//! top-down, and clusters are merged bottom-up, at each step only down to f(n) of them. The binary tree is then widened
//! by [`crate::builders::clusters`].

mod clustering;
mod config;
mod pipeline;

pub(crate) use clustering::cluster;
pub use config::AacConfig;
pub use pipeline::Aac;
