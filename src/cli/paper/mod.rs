//! The verbs of the paper's other figures and its experiments.

pub mod heatmap;
