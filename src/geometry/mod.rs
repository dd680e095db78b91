//! Boxes, rays and indexed triangle meshes.

mod aabb;
mod mesh;
pub(crate) mod ordered;
mod ray;
pub(crate) mod triangle_split;

pub use aabb::Aabb;
pub use mesh::{Dropped, Mesh, MeshError};
pub use ray::{Hit, Ray, Tracer};
