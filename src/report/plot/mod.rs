//! The figures drawn from the rows of a run. A figure is a function from rows to SVG, in a module of its own, with
//! a line in [`figures`].
//!
//! [`figure6`] and [`growth`] choose the points, [`pareto`] finds the front, [`chart`] draws a panel with axes and
//! [`labels`], [`svg`] writes the drawing and [`raster`] turns it into PNG.

pub mod chart;
pub mod figure6;
pub mod growth;
pub mod labels;
pub mod pareto;
pub mod raster;
pub mod svg;

use super::figures::Under;
use crate::bench::row::Row;

/// A drawn figure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drawing {
    /// Name of its file, without ending.
    pub name: &'static str,
    /// The SVG.
    pub svg: String,
}

/// The figures for which `rows` have points.
pub fn figures(rows: &[Row], under: &Under) -> Vec<Drawing> {
    let all = [
        ("figure6", figure6::averaged(rows, under)),
        ("figure6-scenes", figure6::by_scene(rows, under)),
        ("growth", growth::growth(rows)),
    ];
    all.into_iter().filter_map(|(name, svg)| Some(Drawing { name, svg: svg? })).collect()
}
