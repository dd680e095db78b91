//! Reports made from the records of a run: tables and figures.

pub mod ablation;
pub mod chart;
pub mod compare;
pub mod details;
pub mod family;
pub mod figure6;
pub mod figures;
pub mod grid;
pub mod growth_plot;
pub mod labels;
pub mod means;
pub mod paper;
pub mod pareto;
pub mod plot;
pub mod raster;
pub mod readme;
pub mod summary;
pub mod svg;
pub mod table;
pub mod table1;
pub mod targets;
