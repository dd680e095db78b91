//! The verbs of the paper's other figures and its experiments.

pub mod animate;
pub mod arguments;
mod cut_size;
pub mod experiment;
pub mod heatmap;
mod split;
mod told;
