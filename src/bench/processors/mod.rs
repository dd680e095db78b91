//! What builds take of processors: their time, and the instructions and cycles that they count.

pub mod cpu_time;
pub mod hardware_counters;
