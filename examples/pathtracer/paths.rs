//! Paths: diffuse surfaces, a shadow ray to the sun from each, the sky where a path leaves the scene.

use crate::camera::Camera;
use crate::light::Light;
use phr::geometry::Ray;
use phr::glam::Vec3;
use phr::query::{Bvh, Hit};
use phr::random::SplitMix64;
use std::f32::consts::{PI, TAU};

pub struct PathTracer<'a> {
    pub bvh: &'a Bvh,
    pub light: Light,
    pub bounces: u32,
}

/// What surfaces reflect; the loader keeps no materials.
const ALBEDO: Vec3 = Vec3::new(0.75, 0.73, 0.7);

impl PathTracer<'_> {
    /// The mean of so many paths through a pixel.
    pub fn pixel(&self, camera: &Camera, [x, y]: [u32; 2], samples: u32) -> Vec3 {
        let mut random = SplitMix64::new(u64::from(y) << 32 | u64::from(x));
        let mut sum = Vec3::ZERO;
        for _ in 0..samples {
            let ray = camera.ray(x as f32 + random.unit(), y as f32 + random.unit());
            sum += self.radiance(ray, &mut random);
        }
        sum / samples as f32
    }

    /// What comes to the ray's origin along it, by one path.
    fn radiance(&self, mut ray: Ray, random: &mut SplitMix64) -> Vec3 {
        let (mut radiance, mut throughput) = (Vec3::ZERO, Vec3::ONE);
        for bounce in 0..=self.bounces {
            let Some(hit) = self.bvh.intersect(&ray) else {
                return radiance + throughput * self.light.sky(ray.dir);
            };
            // A triangle too small for a normal reflects nothing.
            let Some(normal) = facing(&hit, &ray) else { break };
            throughput *= ALBEDO;
            let from = |dir| Ray { org: offset(&ray, hit.t, normal), dir, ..ray };

            let (to_sun, sun) = self.light.sun(on_sphere(random));
            let cosine = normal.dot(to_sun);
            if cosine > 0.0 && !self.bvh.occluded(&from(to_sun)) {
                radiance += throughput * sun * (cosine / PI);
            }
            if bounce == self.bounces {
                break;
            }
            // Directions as dense as their cosine.
            ray = from((normal + on_sphere(random)).try_normalize().unwrap_or(normal));
        }
        radiance
    }
}

/// The hit's unit normal on the side that the ray comes from.
fn facing(hit: &Hit, ray: &Ray) -> Option<Vec3> {
    let normal = hit.normal.as_dvec3().try_normalize()?.as_vec3();
    Some(if normal.dot(ray.dir) > 0.0 { -normal } else { normal })
}

/// The point hit, so far off its triangle that rays from there do not meet it again.
fn offset(ray: &Ray, t: f32, normal: Vec3) -> Vec3 {
    let point = ray.org + t * ray.dir;
    let error = 1e-5 * point.abs().max(ray.org.abs()).max_element().max(t);
    point + error * normal
}

/// A point of the unit sphere.
fn on_sphere(random: &mut SplitMix64) -> Vec3 {
    let z = 2.0 * random.unit() - 1.0;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * random.unit()).sin_cos();
    Vec3::new(radius * cos, radius * sin, z)
}
