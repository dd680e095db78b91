//! The benchmark driver: what is run ([`plan`]), who is measured ([`contender`]), how ([`run`], [`measure`])
//! and what is written ([`samples`], [`records`], [`environment`]).

mod book;
pub mod contender;
pub mod embree_side;
pub mod environment;
pub mod facts;
pub mod folder;
pub mod load;
pub mod measure;
pub mod plan;
pub mod planned_scene;
pub mod random;
pub mod rays;
pub mod records;
pub mod run;
pub mod samples;
pub mod statistics;
pub mod summary;
pub mod warnings;
