//! Reports made from the records of a run: tables.

pub mod grid;
pub mod table;
