//! The light: a clear sky and a sun.

use phr::glam::Vec3;
use phr::scene::View;

pub struct Light {
    up: Vec3,
    /// Unit vector to the middle of the sun.
    sun: Vec3,
}

/// What a surface gets that faces the sun.
const SUN: Vec3 = Vec3::new(4.2, 3.8, 3.2);
/// Radius of the sun as seen from a distance of 1; larger than ours, for softer shadows.
const RADIUS: f32 = 0.03;

impl Light {
    /// A sky over the scene, the sun behind the camera's right shoulder.
    pub fn over(view: &View) -> Self {
        let up = view.up.try_normalize().unwrap_or(Vec3::Y);
        let forward = (view.target - view.eye).reject_from(up).normalize_or_zero();
        Self { up, sun: (up + 0.8 * forward.cross(up) - 0.7 * forward).normalize() }
    }

    /// What comes from the sky in a unit direction.
    pub fn sky(&self, dir: Vec3) -> Vec3 {
        let height = self.up.dot(dir);
        let (horizon, zenith) = (Vec3::new(0.6, 0.66, 0.74), Vec3::new(0.18, 0.34, 0.7));
        let ground = Vec3::new(0.32, 0.3, 0.28);
        if height < 0.0 {
            horizon.lerp(ground, (-8.0 * height).min(1.0))
        } else {
            horizon.lerp(zenith, height.sqrt())
        }
    }

    /// A unit direction to the sun, and what a surface gets from there that faces it.
    pub fn sun(&self, on_sphere: Vec3) -> (Vec3, Vec3) {
        ((self.sun + RADIUS * on_sphere).normalize(), SUN)
    }
}
