//! Our single-ray kernel over a [`WideBvh`](crate::bvh::WideBvh).
//!
//! 1. [`tracer`]: picks the instruction set, and runs batches of rays;
//! 2. [`sound_tree`]: proves that links may be followed unchecked;
//! 3. [`traverse`]: the algorithm, generic over its two tests, with a [`stack`] of fixed size;
//! 4. [`scalar`] and `avx2`: the tests of boxes and triangles per instruction set;
//! 5. [`counts`]: nodes and leaf blocks visited.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod counts;
mod scalar;
mod sound_tree;
mod stack;
mod tracer;
mod traverse;

pub use counts::TraversalCounts;
pub use tracer::{BvhTracer, kernel_isa};
