//! The paper's other figures and its experiments. Each measures, keeps what it measured as CSV, and draws from that alone:
//! the same file gives the same picture, byte for byte.
//!
//! * [`heatmap`], Figure 1: traversal steps of one view.

pub mod heatmap;
