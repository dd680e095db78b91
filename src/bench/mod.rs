//! The benchmark driver. A [`plan`] lists scenes and [`cell`]s; a [`run`] visits each cell in interleaved rounds;
//! a [`visit`] has a [`contender`] build its tree and times it under each kernel; the [`recorder`] keeps
//! [`samples`], [`rows`] and [`environment`] on disk.

pub mod build_times;
pub mod cell;
pub mod contender;
pub mod cpu_time;
pub mod environment;
pub mod error;
pub mod files;
pub mod plan;
pub mod planned_scene;
pub mod pools;
pub mod random;
pub mod rays;
pub mod recorder;
pub mod results_dir;
pub mod row;
pub mod rows;
pub mod run;
pub mod samples;
pub mod settings;
pub mod statistics;
pub mod traces;
pub mod tree_facts;
pub mod visit;
pub mod visit_times;
pub mod warnings;
