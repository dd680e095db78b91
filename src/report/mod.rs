//! Reports made from the records of a run: tables.

pub mod details;
pub mod figures;
pub mod grid;
pub mod labels;
pub mod means;
pub mod paper;
pub mod pareto;
pub mod raster;
pub mod svg;
pub mod table;
pub mod table1;
