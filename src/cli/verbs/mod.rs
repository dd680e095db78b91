//! The verbs of the command line, each with its arguments.

pub mod ablation;
pub mod advise;
pub mod bench;
pub mod build;
pub mod child;
pub mod compare;
pub mod kernels;
pub mod pages;
pub mod plot;
pub mod records;
pub mod render;
pub mod scaling;
pub mod scenes;
pub mod targets;
pub mod verify;
