//! Kernels against each other: single rays, packets, streams and batches over the same trees with the same recorded
//! rays, by turns in one process. Ray queries are all that is timed.

mod contestants;
pub mod leaks;
mod measure;
pub mod row;

pub use contestants::{Trees, left_out};
pub use measure::{KernelSettings, measure};
