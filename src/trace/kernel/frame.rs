//! A ray prepared for the watertight tests, the same for all instruction sets.
//!
//! Triangles are tested as by Woop, Benthin and Wald ("Watertight Ray/Triangle Intersection", JCGT 2013): sheared
//! so that the ray becomes an axis through the origin, they are hit if the origin lies in their projection. The
//! corners are rounded by that, but equally for all triangles that share them, and the tests of the projected edges
//! are exact. So the tests answer without gaps for a mesh whose corners were moved a little, and boxes are padded
//! by as much. Unlike theirs, distances are not weighted means of the corners': where a ray grazes a triangle,
//! errors of the weights move it far along the ray. They are those of the triangle's plane.

use crate::geometry::{Aabb, Ray};
use glam::Vec3A;

/// Half a unit in the last place of 1: the relative error of a rounded operation.
const ROUNDING: f32 = f32::EPSILON / 2.0;

/// Components of the direction below this share of the largest are taken for it: over the length of the scene that
/// moves a ray by a thousandth of the padding, and reciprocals stay finite.
const LEAST_SHARE: f32 = 1.0 / (1 << 30) as f32;

/// The axis after each.
const NEXT: [usize; 4] = [1, 2, 0, 1];

/// A prepared ray.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    axes: [usize; 3],
    /// Origin, by these axes.
    pub org: [f32; 3],
    /// The direction's x and y per z, and 1 per z.
    pub shear: [f32; 3],
    /// Reciprocals of the direction, by the scene's axes.
    pub rdir: [f32; 3],
    /// The origin times `rdir`, for the planes met first, padded towards the ray.
    pub near_org_rdir: [f32; 3],
    /// The same for the planes met last, padded away from the ray.
    pub far_org_rdir: [f32; 3],
    /// Start of the interval.
    pub tnear: f32,
}

impl Frame {
    /// Prepares a ray that [`scaled`] returned, for a tree of the given bounds.
    #[inline(always)]
    pub fn new(ray: &Ray, bounds: Aabb) -> Self {
        let (org, dir) = (Vec3A::from(ray.org), Vec3A::from(ray.dir));
        let size = dir.abs();
        let z = usize::from(size.y > size.x);
        let z = if size.z > size.x.max(size.y) { 2 } else { z };
        let axes = [NEXT[z], NEXT[z + 1], z];
        let least = Vec3A::splat(LEAST_SHARE * size.max_element());
        let rdir = Vec3A::select(size.cmplt(least), least, dir).recip();
        let by_axis = |v: Vec3A| axes.map(|axis| v.to_array()[axis]);
        let [x, y, _] = by_axis(dir);
        let [_, _, per_z] = by_axis(rdir);
        let outwards = rdir.signum() * padding(org, bounds);
        Self {
            axes,
            org: by_axis(org),
            shear: [x * per_z, y * per_z, per_z],
            rdir: rdir.to_array(),
            near_org_rdir: ((org + outwards) * rdir).to_array(),
            far_org_rdir: ((org - outwards) * rdir).to_array(),
            // Not -0, as which valid rays may begin.
            tnear: if ray.tnear > 0.0 { ray.tnear } else { 0.0 },
        }
    }

    /// The axes x, y and z of the sheared space, each below 3: z is that of the direction's largest component.
    #[inline(always)]
    pub fn axes(&self) -> [usize; 3] {
        self.axes
    }
}

/// How far boxes are padded. With u the relative error of an operation and m the largest difference of a coordinate
/// of the scene from the origin's, sheared corners lie at most 7 u m beside their places. The distances of planes
/// are in error by as much as if the planes lay at most 3 u m and 3 u times the origin's largest coordinate beside
/// theirs, and the least share of a direction adds u m / 64. The factors are larger by half and more: boxes of clipped
/// triangles are rounded, too.
#[inline(always)]
fn padding(org: Vec3A, bounds: Aabb) -> f32 {
    let farthest = (bounds.min - org).abs().max((bounds.max - org).abs()).max_element();
    ROUNDING * (16.0 * farthest + 8.0 * org.abs().max_element())
}

/// The ray with its direction scaled by a power of two, so that the largest component is between 1 and 2 (less for
/// denormal ones), and the factor that turns distances along it back. A ray without direction becomes one without
/// length.
#[inline(always)]
pub(super) fn scaled(ray: &Ray) -> (Ray, f32) {
    const EXPONENT: u32 = 0x7f80_0000;
    const LEAST: u32 = 0x0080_0000;
    let largest = ray.dir.abs().max_element();
    let exponent = (largest.to_bits() & EXPONENT).max(LEAST);
    let factor = f32::from_bits(2 * 1f32.to_bits() - exponent);
    let inverse = f32::from_bits(exponent);
    let tfar = if largest > 0.0 { ray.tfar * inverse } else { f32::NEG_INFINITY };
    (Ray { tnear: ray.tnear * inverse, tfar, dir: ray.dir * factor, ..*ray }, factor)
}
