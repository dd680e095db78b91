//! Bounding volume hierarchies by *Progressive Hierarchical Refinement* (Hendrich, Meister, Bittner,
//! Eurographics 2017), beside Embree's builders, measured with the same rays.
//!
//! # From a scene file to a row of the table
//!
//! 1. [`scene`] loads or generates an indexed triangle [`geometry::Mesh`] and its cameras;
//! 2. [`builders`] computes primitive boxes, Morton codes and the auxiliary LBVH, refines cuts of it and emits
//! 3. a [`bvh::WideBvh`]: 4-wide nodes and leaf blocks of four triangles, whose cost [`bvh`] measures;
//! 4. [`trace`] records a path tracer's rays once per view and traces them through any tree;
//! 5. [`embree`] does the same with the distribution's Embree;
//! 6. [`bench`](mod@bench) times both in interleaved rounds and writes records, which [`report`] turns into tables.
//!
//! Each module depends only on those before it:
//! `geometry -> scene -> bvh -> builders -> embree -> trace -> bench -> report -> cli`.

pub mod builders;
pub mod bvh;
#[cfg(feature = "embree")]
pub mod embree;
pub mod geometry;
mod memory;
mod parallel;
pub mod random;
pub mod scene;
mod simd;
pub mod trace;

#[cfg(feature = "harness")]
pub mod bench;
#[cfg(feature = "harness")]
pub mod cli;
#[cfg(feature = "harness")]
pub mod report;

/// The examples of the README are compiled and run with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct ReadmeExamples;
