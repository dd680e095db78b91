//! All figures that are drawn from the rows of a run. A figure is a function from rows to SVG; a new one is
//! a module of its own and a line here.

use super::figures::Under;
use super::{figure6, growth_plot};
use crate::bench::records::Row;

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
        ("growth", growth_plot::growth(rows)),
    ];
    all.into_iter().filter_map(|(name, svg)| Some(Drawing { name, svg: svg? })).collect()
}
