//! The benchmark driver: what is run ([`plan`]), who is measured ([`contender`]), how ([`run`], [`measure`])
//! and what is written ([`samples`], [`row`], [`environment`]).

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
pub mod tree_facts;
pub mod visit;
pub mod warnings;
