//! Verbs that make one results folder of another.

pub mod merge;
pub mod reduce;
