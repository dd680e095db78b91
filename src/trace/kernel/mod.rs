//! Our single-ray kernel over a [`WideBvh`](crate::bvh::WideBvh).
//!
//! 1. [`tracer`]: picks the instruction set, and runs batches of rays;
//! 2. [`sound_tree`]: proves that links may be followed unchecked;
//! 3. [`traverse`]: the algorithm, generic over its two tests, with a [`stack`] of fixed size; [`children`]: which
//!    child is next;
//! 4. [`scalar`] and `avx2`: the tests of boxes and triangles per instruction set;
//! 5. [`watertight`]: the same traversal with tests that leave no gap between triangles, over [`corners`] instead of
//!    edges, and the ray as those tests see it ([`frame`]);
//! 6. [`batch`]: many rays at once;
//! 7. [`custom`]: the same traversal with a test of the caller's in place of that of triangles;
//! 8. [`filtered`]: the same traversal with hits that the caller may turn down;
//! 9. [`counts`]: nodes and leaf blocks visited.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod batch;
mod children;
mod corners;
mod counts;
mod custom;
mod filtered;
mod frame;
mod scalar;
mod sound_tree;
mod stack;
mod tracer;
mod traverse;
mod watertight;

pub use batch::BatchTracer;
pub use counts::TraversalCounts;
pub use sound_tree::ProvenTree;
pub use tracer::{BvhTracer, kernel_isa};
pub(crate) use watertight::Corners;
pub use watertight::WatertightTracer;
