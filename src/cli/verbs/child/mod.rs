//! Verbs that this program starts itself with, for measurements in processes of their own.

pub mod memory;
pub mod turns;
