//! Is B faster than A, slower or the same? [`runs`] compares two runs, figure by figure, [`by_turns`] two programs that were
//! measured beside each other.

pub mod by_turns;
pub mod runs;

pub use runs::{Outcome, Recorded, Verdict};
