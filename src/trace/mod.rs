//! Traversal kernels, the path tracer and its recorded rays.
//!
//! * [`BvhTracer`] answers closest-hit and any-hit queries over any [`crate::bvh::WideBvh`], with the best
//!   instructions the machine has ([`Isa`]);
//! * [`WatertightTracer`] does so without gaps between triangles that share an edge or a vertex;
//! * [`record`] runs a path tracer once per view and keeps its rays ([`RayBatches`]), so that every tree
//!   traces the very same ones; [`render`] is the same path tracer without the recording;
//! * [`verify`] compares the hits of two tracers, with [`oracle`] in extended precision to settle disputes.

mod batches;
mod brute_force;
mod camera;
mod double_double;
mod image;
mod kernel;
mod lights;
pub mod oracle;
mod path;
mod pixel_random;
#[cfg(feature = "harness")]
pub(crate) mod scale;
mod segment;
pub mod verify;

pub use crate::simd::Isa;
pub use batches::{RayBatches, RayKind, any_in_parallel, closest_in_parallel};
pub use brute_force::BruteForce;
pub use camera::Camera;
pub use image::Image;
#[cfg(feature = "harness")]
pub use image::ImageError;
pub(crate) use kernel::Corners;
pub use kernel::{BatchTracer, BvhTracer, ProvenTree, TraversalCounts, WatertightTracer, kernel_isa};
pub use path::{PathSettings, Recording, record, render};
pub use verify::{hit_count, hit_hash};
