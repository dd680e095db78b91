//! Batches of rays over a [`WideBvh`](crate::bvh::WideBvh).
//!
//! 1. [`interleave`]: several rays at a time on one core, so that waiting for memory costs nothing; whatever the rays;
//! 2. [`group`] and [`traverse`]: 64 neighbours of one octant of directions as packets, one lane per ray: a node's boxes
//!    are tested against bounds of all rays, then against the packets that are still there. Few rays that are left of a
//!    group go on as single rays;
//! 3. [`tracer`]: tries groups now and then, and goes on with them as long as they hold together.

#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod group;
#[cfg(target_arch = "x86_64")]
mod interleave;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code, unused_imports))]
mod tracer;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
mod traverse;

pub use tracer::BatchTracer;
