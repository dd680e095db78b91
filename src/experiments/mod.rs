//! The paper's other figures and its experiments. Each measures, keeps what it measured as CSV, and draws from that
//! alone: the same file gives the same picture, byte for byte.
//!
//! * [`heatmap`], Figure 1: traversal steps of one view;
//! * [`split`], Figures 3 and 5: a split as pictures;
//! * [`cut_size`], Figure 4: sizes of cuts by depth;
//! * [`animation`], section 5.6, left open there: trees that follow a moving scene;
//! * [`contest`], sections 4.2 to 5.5: builders that differ in one thing, measured by the benchmark.

pub mod animation;
pub mod contest;
pub mod cut_size;
pub mod heatmap;
pub mod split;
