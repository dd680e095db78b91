//! An instance, ready for rays: the way to its object's space, and its box in the world.

use super::{Bvh, Hit};
use crate::builders::Primitives;
use crate::geometry::{Aabb, Ray};
use glam::{Affine3A, DAffine3, DMat3, DVec3, Mat3A, Vec3A};
use std::borrow::Borrow;

/// An instance.
#[derive(Debug)]
pub(super) struct Placed<B> {
    /// Its object.
    pub bvh: B,
    /// Its box in the world.
    pub bounds: Aabb,
    /// From the world to its object's space.
    pub to_object: Affine3A,
    /// Takes normals to the world, with the factor by which areas grow.
    normals: Mat3A,
}

impl<B: Borrow<Bvh>> Placed<B> {
    /// An object at its place; what is wrong with the transform otherwise.
    pub fn new(bvh: B, transform: Affine3A) -> Result<Self, &'static str> {
        if !transform.is_finite() {
            return Err("it is not finite");
        }
        // In double precision: the inverse of a transform by scale and rotation is then right to the last place.
        let linear = DMat3::from_cols(
            transform.matrix3.x_axis.as_dvec3(),
            transform.matrix3.y_axis.as_dvec3(),
            transform.matrix3.z_axis.as_dvec3(),
        );
        let to_world = DAffine3 { matrix3: linear, translation: transform.translation.as_dvec3() };
        let determinant = linear.determinant();
        // Rounding leaves so much of the determinant of a matrix that is singular.
        let [a, b, c] = [linear.x_axis, linear.y_axis, linear.z_axis].map(DVec3::length);
        if determinant.abs() <= 1e-7 * a * b * c {
            return Err("it flattens the object, so that it cannot be inverted");
        }
        let inverse = to_world.inverse();
        let to_object = Affine3A::from_cols_array(&inverse.to_cols_array().map(|x| x as f32));
        let normals = (inverse.matrix3.transpose() * determinant).as_mat3();
        if !to_object.is_finite() || !normals.is_finite() {
            return Err("its inverse is out of the range of f32");
        }
        let bounds = boxed(bvh.borrow().bounds(), &to_world);
        let is_finite = bounds.min.is_finite() && bounds.max.is_finite();
        if !is_finite || bounds.min.abs().max(bounds.max.abs()).max_element() >= Ray::LARGEST {
            return Err("it takes the object beyond 1.8e18");
        }
        Ok(Self { bvh, bounds, to_object, normals: normals.into() })
    }

    /// The ray in the object's space; distances along it are the same.
    #[inline(always)]
    pub fn local(&self, ray: &Ray) -> Ray {
        Ray {
            org: self.to_object.transform_point3a(ray.org.into()).into(),
            dir: self.to_object.transform_vector3a(ray.dir.into()).into(),
            ..*ray
        }
    }

    /// A hit of the object in the world: its normal is the product of the transformed edges.
    pub fn to_world(&self, hit: Hit) -> Hit {
        Hit { normal: self.normals.mul_vec3(hit.normal), ..hit }
    }
}

impl<B: Sync> Primitives for Vec<Placed<B>> {
    fn len(&self) -> usize {
        self.len()
    }

    fn bounds(&self, id: u32) -> Aabb {
        self[id as usize].bounds
    }
}

/// The box around a transformed box; of an empty one, a point that nothing hits.
fn boxed(bounds: Aabb, to_world: &DAffine3) -> Aabb {
    let around = |center: DVec3, extent: DVec3| {
        // Rays are rounded when they are taken to the object.
        let slack = (center.abs() + extent) * (4.0 * f64::from(f32::EPSILON));
        Aabb::new((center - extent - slack).as_vec3a(), (center + extent + slack).as_vec3a())
    };
    if bounds.is_empty() {
        return around(to_world.translation, DVec3::ZERO);
    }
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let half = 0.5 * (max - min);
    let DMat3 { x_axis, y_axis, z_axis } = to_world.matrix3;
    let extent = x_axis.abs() * half.x + y_axis.abs() * half.y + z_axis.abs() * half.z;
    around(to_world.transform_point3(0.5 * (min + max)), extent)
}

/// A ray as a quick test of boxes sees it: leaves hold up to four instances, and one box is less than one instance.
#[derive(Clone, Copy)]
pub(super) struct Slabs {
    org: Vec3A,
    rdir: Vec3A,
}

impl Slabs {
    /// Of a ray.
    pub fn of(ray: &Ray) -> Self {
        let least = |x: f32| if x.abs() < 1e-18 { 1e-18 } else { x };
        Self { org: ray.org.into(), rdir: Vec3A::ONE / Vec3A::from_array(ray.dir.to_array().map(least)) }
    }

    /// Whether the ray meets a box, or nearly does.
    #[inline(always)]
    pub fn meet(&self, bounds: Aabb, ray: &Ray) -> bool {
        let (a, b) = ((bounds.min - self.org) * self.rdir, (bounds.max - self.org) * self.rdir);
        let near = a.min(b).max_element().max(ray.tnear);
        let far = (a.max(b).min_element() * (1.0 + 4.0 * f32::EPSILON)).min(ray.tfar);
        near <= far
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_hold_their_transformed_corners() {
        let bounds = Aabb::new(Vec3A::new(-1.0, 2.0, 0.0), Vec3A::new(3.0, 2.5, 0.0));
        let transform = DAffine3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7)
            * DAffine3::from_scale(DVec3::new(-2.0, 0.5, 9.0));
        let boxed = boxed(bounds, &transform);
        let corners: Vec<DVec3> = (0..8)
            .map(|i| {
                let at = |axis: usize| if i >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] };
                transform.transform_point3(DVec3::new(at(0).into(), at(1).into(), at(2).into()))
            })
            .collect();
        let tight: Aabb = corners.iter().map(|c| Aabb::new(c.as_vec3a(), c.as_vec3a())).collect();
        assert!(boxed.contains(tight), "{boxed:?} {tight:?}");
        assert!((boxed.extent() - tight.extent()).max_element() < 1e-4);
    }
}
