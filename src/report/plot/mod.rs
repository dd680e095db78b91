//! The figures drawn from the rows of a run. A figure is a function from rows to SVG, in a module of its own, with
//! a line in [`figures`] and a name in [`FIGURES`].
//!
//! [`figure6`], [`growth`], [`threads`] and [`phases`] choose the points, [`workers`] draws scaling, [`total_time`]
//! advice; [`pareto`] finds the front, [`chart`] draws a panel with axes and [`labels`] and [`key`], [`svg`] writes the
//! drawing and [`raster`] turns it into PNG. It is drawn by hand: the chart crates place no labels beside crowded
//! points, and their texts depend on the fonts of the machine, so that no file would stay the same. Bars and lines
//! without labels, which such a crate would draw as well, come from the same writer: all figures have the same colours
//! and keys, and are checked in the same way, byte for byte.

pub mod chart;
pub mod families;
pub mod figure6;
pub mod growth;
pub mod key;
pub mod labels;
pub mod pareto;
pub mod phases;
pub mod raster;
pub mod svg;
pub mod threads;
pub mod ticks;
pub mod total_time;
pub mod workers;

use super::figures::Under;
use crate::bench::phases::PhaseRow;
use crate::bench::results_dir::FIGURES;
use crate::bench::row::Row;

/// A drawn figure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drawing {
    /// Name of its file, without ending.
    pub name: &'static str,
    /// The SVG.
    pub svg: String,
}

/// The figures for which `rows`, and the phases of their builds, have points. `figure6-own` is left out where
/// `figure6` already compares each engine's trees under its own kernel.
pub fn figures(rows: &[Row], phase_rows: &[PhaseRow], under: &Under) -> Vec<Drawing> {
    let own = if *under == Under::Own { None } else { figure6::averaged(rows, &Under::Own) };
    // In the order of their names.
    let all: [Option<String>; FIGURES.len()] = [
        figure6::averaged(rows, under),
        own,
        figure6::beside_paper(rows, under),
        figure6::by_scene(rows, under),
        growth::growth(rows),
        threads::threads(rows),
        phases::phases(rows, phase_rows),
    ];
    FIGURES.into_iter().zip(all).filter_map(|(name, svg)| Some(Drawing { name, svg: svg? })).collect()
}
