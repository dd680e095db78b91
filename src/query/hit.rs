//! What a ray hit.

use crate::geometry;
use glam::Vec3;

/// The closest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray's direction.
    pub t: f32,
    /// Barycentric coordinate of the triangle's second vertex, 0 to 1.
    pub u: f32,
    /// Barycentric coordinate of the triangle's third vertex, 0 to 1.
    pub v: f32,
    /// Triangle, an index into the mesh.
    pub prim: u32,
    /// Geometric normal: the product of the edges from the first vertex to the second and to the third. It is as
    /// long as twice the triangle's area, points to where the vertices run counter-clockwise, and overflows or
    /// vanishes if that area does.
    pub normal: Vec3,
}

impl From<Hit> for geometry::Hit {
    /// The hit without its normal, as tracers tell it.
    fn from(hit: Hit) -> Self {
        let Hit { t, u, v, prim, normal: _ } = hit;
        Self { t, u, v, prim }
    }
}
