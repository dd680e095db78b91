//! How builders would scale to more threads than the machine has: their tasks are timed one by one on one thread, and
//! scheduled on any number of workers.

mod measure;
pub mod row;
mod simulate;

pub use measure::{ScalingSettings, measure};
