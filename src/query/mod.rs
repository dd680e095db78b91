//! The library's front door: [`Bvh`] is built from a mesh and answers rays; [`PrimitiveBvh`] from anything that has
//! boxes, with tests of the caller's; [`InstanceBvh`] from many places of such meshes; through a [`WatertightBvh`] no
//! ray slips.
//!
//! What is fixed, and tested in `tests/library/query`:
//!
//! * **Interval**: a hit at `t` counts if `tnear < t <= tfar`, as in Embree. `tfar` may be infinite, `tnear` may
//!   not; a ray whose interval is empty (`tfar <= tnear`) misses. Distances are compared before they are divided, as
//!   Embree's are, and that rounds: a hit may be told an ulp or two out of the interval, and one at its very end may be
//!   missed. A ray that goes on behind a hit should begin some ulps after it.
//! * **Direction**: any length from 1e-10 on, of components of up to 1.844e18; `t` is in units of it, so that the
//!   hit lies at `org + t * dir`. Components may be zero, of either sign, or denormal; a ray whose direction is
//!   zero misses. Boxes see components below 1e-18 as 1e-18, as Embree's do, so that shorter rays may miss. Where
//!   products leave the range of `f32` closest hits are missed, though any hit may be found: those of direction and
//!   edges (all components below 1e-38, say), and those of two edges and the distance from the origin. The latter
//!   stay within it where edges and distances are all between 1e-12 and 5e12. No hit has a distance that is infinite,
//!   zero or NaN.
//! * **Faces**: both sides of a triangle are hit. The normal is not turned towards the ray.
//! * **Edges** belong to their triangles, but rounding decides: a ray at an edge may slip between the two triangles
//!   that share it, or past a triangle that it touches at the border of a box it runs along. Of hits at the same
//!   distance any may be reported. Where a box ends at -0.0 at such a ray, a batch may answer otherwise than the ray by
//!   itself.
//! * **Invalid rays** miss, those that are not [`Ray::is_valid`](crate::geometry::Ray::is_valid): a NaN, a component of
//!   origin or direction beyond 1.844e18 (Embree's limit), a `tnear` that is negative or infinite. No ray panics.
//! * **Filters**: [`Bvh::intersect_filtered`], [`Bvh::occluded_filtered`] and those of [`InstanceBvh`] ask a closure
//!   about hits that they would report, and go on where it turns one down.
//! * **Threads**: a [`Bvh`] is `Send` and `Sync`. A query runs on the thread that calls it and allocates nothing
//!   per ray; a batch takes some 100 KiB of its stack.

mod built;
mod bvh;
mod config;
mod filtered;
mod hit;
mod instances;
mod moving;
mod placed;
mod places;
mod primitives;
mod watertight;
mod widths;

pub use bvh::Bvh;
pub use config::{BvhConfig, BvhError};
pub use hit::Hit;
pub use instances::{Instance, InstanceBvh, InstanceHit};
pub use primitives::{PrimitiveBvh, PrimitiveHit};
pub use watertight::WatertightBvh;
