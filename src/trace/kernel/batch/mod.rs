//! Batches of rays over a [`WideBvh`](crate::bvh::WideBvh).
//!
//! 1. [`stream`]: neighbours go down the tree together, so that a branch is taken for many of them at a time;
//! 2. [`interleave`]: several rays are under way on one core, so that one works while another waits for memory;
//!    for rays in any order;
//! 3. [`tracer`]: tries streams now and then, and goes on with them as long as the rays stay together.

#[cfg(target_arch = "x86_64")]
mod interleave;
#[cfg(target_arch = "x86_64")]
mod stream;
mod tracer;

pub use tracer::BatchTracer;
