//! The verbs of the command line, each with its arguments.

pub mod ablation;
pub mod advise;
pub mod bench;
pub mod build;
pub mod child;
pub mod compare;
pub mod kernels;
pub mod merge;
pub mod plot;
pub mod readme;
pub mod reduce;
pub mod render;
pub mod scaling;
pub mod scenes;
pub mod table;
pub mod targets;
pub mod verify;
