//! Figure 1 of the paper: the traversal steps of a view's primary rays, pixel by pixel, under several builders side by
//! side.
//!
//! `measure` counts, `records` keeps the counts, `draw` colours them.

pub mod draw;
pub mod measure;
pub mod records;

pub use draw::draw;
pub use measure::{Request, measure};
pub use records::{HeatmapRow, MOST_PIXELS, Panel, places, read, write};
