//! The benchmark driver. A [`plan`] lists scenes and [`cell`]s of the builders [`chosen`]; a [`run`] visits each
//! cell in interleaved rounds; a [`visit`] has a [`contender`] build its tree and times it under each kernel; the
//! [`recorder`] keeps [`samples`], [`rows`] and [`environment`] on disk. [`kernels`] times kernels alone, [`turns`]
//! two programs beside each other, [`scaling`] the tasks of a build; [`quick`] measures for decisions, within
//! seconds.

pub mod cell;
pub mod contender;
pub mod error;
pub mod kernels;
pub mod memory;
pub mod plan;
pub mod precision;
pub mod processors;
pub mod quick;
pub mod rays;
pub mod records;
pub mod run;
pub mod scaling;
pub mod turns;
pub mod visit;

pub use contender::pools;
pub use plan::{chosen, planned_scene, settings, shard};
pub use processors::{cpu_time, hardware_counters};
pub use quick::tune;
pub use records::{
    build_times, environment, environment::moment, files, merge, phases, recorder, results_dir, rounds, row,
    rows, samples, statistics, tree_facts, visit_times, warnings,
};
