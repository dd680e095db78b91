//! Reports made from the records of a run: tables.

pub mod grid;
pub mod means;
pub mod ratios;
pub mod table;
