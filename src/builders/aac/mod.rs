//! Approximate agglomerative clustering (Gu, He, Fatahalian, Blelloch 2013): Morton order partitions the triangles
//! top-down, and clusters are merged bottom-up, at each step only down to f(n) of them. The binary tree is then widened
//! like all.

mod clustering;
mod collapse;
mod config;
mod emit;
mod pipeline;

pub use config::AacConfig;
pub use pipeline::Aac;
