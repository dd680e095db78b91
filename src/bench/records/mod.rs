//! The records of a run: samples as taken, the rows made from them, the environment, and their files.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod build_times;
pub mod environment;
pub mod files;
pub mod merge;
pub mod phases;
pub mod recorder;
pub mod results_dir;
pub mod rounds;
pub mod row;
pub mod rows;
pub mod samples;
pub mod statistics;
pub mod tree_facts;
pub mod visit_times;
pub mod warnings;
