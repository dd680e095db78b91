//! Reports made from the records of a run: tables and figures.

pub mod chart;
pub mod compare;
pub mod details;
pub mod figure6;
pub mod figures;
pub mod grid;
pub mod labels;
pub mod means;
pub mod paper;
pub mod pareto;
pub mod plot;
pub mod raster;
pub mod readme;
pub mod svg;
pub mod table;
pub mod table1;
