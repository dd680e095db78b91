//! Rays and hits.

use glam::Vec3;

/// A ray segment: a hit at parameter `t` counts if `tnear < t <= tfar`, as in Embree.
/// `dir` need not be a unit vector; `t` is in units of its length.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Origin, scene units.
    pub org: Vec3,
    /// Start of the segment, exclusive; >= 0 and finite.
    pub tnear: f32,
    /// Direction.
    pub dir: Vec3,
    /// End of the segment, inclusive; may be infinite.
    pub tfar: f32,
}

impl Ray {
    /// Largest coordinate that Embree accepts (its `FLT_LARGE`); anything larger aborts Debian's build.
    pub const LARGEST: f32 = 1.844e18;

    /// The ray from `org` in the direction `dir` without an end: `tnear` 0, `tfar` infinite. Both are a `Vec3` or an
    /// array of three numbers.
    pub fn new(org: impl Into<Vec3>, dir: impl Into<Vec3>) -> Self {
        Self { org: org.into(), tnear: 0.0, dir: dir.into(), tfar: f32::INFINITY }
    }

    /// True if Embree accepts the ray: components of origin and direction up to [`Ray::LARGEST`], `tnear` finite and
    /// not negative, no NaN.
    pub fn is_valid(&self) -> bool {
        // Without short-circuits, so that a loop of nothing else compiles to vector code.
        let bounded = |v: Vec3| {
            (v.x.abs() <= Self::LARGEST) & (v.y.abs() <= Self::LARGEST) & (v.z.abs() <= Self::LARGEST)
        };
        bounded(self.org)
            & bounded(self.dir)
            & (self.tnear >= 0.0)
            & (self.tnear < f32::INFINITY)
            & !self.tfar.is_nan()
    }
}

/// The closest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Hit {
    /// Ray parameter of the hit; infinite for a miss.
    pub t: f32,
    /// Barycentric coordinate of the triangle's second vertex.
    pub u: f32,
    /// Barycentric coordinate of the triangle's third vertex.
    pub v: f32,
    /// Triangle, an index into the mesh; [`Hit::NONE`] for a miss.
    pub prim: u32,
}

impl Hit {
    /// The triangle id of a miss.
    pub const NONE: u32 = u32::MAX;
    /// A miss.
    pub const MISS: Self = Self { t: f32::INFINITY, u: 0.0, v: 0.0, prim: Self::NONE };

    /// The hit, or a miss if its distance is no positive number: the products of the test left the range of `f32`.
    #[inline(always)]
    pub(crate) fn measured(self) -> Self {
        if self.is_hit() & (self.t > 0.0) & (self.t < f32::INFINITY) { self } else { Self::MISS }
    }

    /// True if a triangle was hit.
    #[inline]
    pub fn is_hit(&self) -> bool {
        self.prim != Self::NONE
    }
}

/// Anything that answers ray queries over one mesh: our kernel over any tree, or Embree.
/// Calls are single-threaded; callers share a tracer among threads and give each its own batch.
pub trait Tracer: Sync {
    /// The closest hit of each ray. `hits` has the length of `rays`.
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]);

    /// Whether anything is hit by each ray. `occluded` has the length of `rays`.
    fn any(&self, rays: &[Ray], occluded: &mut [bool]);
}
