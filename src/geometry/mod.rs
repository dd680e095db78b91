//! Boxes, rays, indexed triangle meshes and clipped triangles.

mod aabb;
mod fingerprint;
mod mesh;
mod mesh_error;
pub(crate) mod ordered;
mod polygon;
mod ray;
pub(crate) mod triangle_split;

pub use aabb::Aabb;
pub use mesh::Mesh;
pub use mesh_error::{Dropped, MeshError, MoveError};
pub(crate) use polygon::Polygon;
pub use ray::{Hit, Ray, Tracer};
