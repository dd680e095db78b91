//! Experiments that are runs: contenders that differ in one thing, built and traced by the benchmark itself,
//! verified and in interleaved rounds, and compared with one another.
//!
//! [`experiment`] is what makes one, [`list`] has them, [`variants`] and [`methods`] their builders, [`kinds`]
//! names scenes of a kind; [`compared`] makes ratios of their rows, `findings` tells what came of it in words,
//! [`effects`] and [`fronts`] draw it. [`grid`] tells of the grid of parameters and [`order`] of the paper's
//! methods what no comparison of two does.

pub mod compared;
pub mod effects;
pub mod experiment;
pub mod findings;
pub mod fronts;
pub mod grid;
pub mod kinds;
pub mod list;
pub mod methods;
pub mod order;
pub mod variants;

pub use experiment::Experiment;
pub use findings::findings;
pub use list::{EXPERIMENTS, by_name};

use crate::bench::row::Row;
use crate::report::figures::Under;
use crate::report::plot::Drawing;

/// The figures of an experiment over trees of `width`; those for which the rows have no points are left out.
pub fn figures(experiment: &Experiment, rows: &[Row], width: u32) -> Vec<Drawing> {
    let under = Under::best(rows);
    let effects = effects::draw(experiment, rows, width, &under);
    let families = experiment.families.map(|families| families());
    let mean = families.as_ref().and_then(|families| fronts::mean(experiment, families, rows, width, &under));
    let scenes =
        families.as_ref().and_then(|families| fronts::by_scene(experiment, families, rows, width, &under));
    let all = [("effects", effects), ("fronts", mean), ("fronts-scenes", scenes)];
    all.into_iter().filter_map(|(name, svg)| Some(Drawing { name, svg: svg? })).collect()
}
