//! Is B faster than A, slower or the same? [`runs`] compares two runs, figure by figure, [`by_turns`] two programs
//! that were measured beside each other, [`machines`] the shards of one run on unlike machines.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod by_turns;
pub mod machines;
pub mod runs;

pub use runs::{Change, Outcome, Recorded};
