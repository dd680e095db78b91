//! The light: a clear sky and a sun.

use phr::glam::Vec3;

pub struct Light {
    up: Vec3,
    /// Unit vector to the middle of the sun.
    sun: Vec3,
}

/// What a surface gets that faces the sun.
const SUN: Vec3 = Vec3::new(2.6, 2.3, 1.9);
/// Radius of the sun as seen from a distance of 1; larger than ours, for softer shadows.
const RADIUS: f32 = 0.03;

impl Light {
    /// A sky whose zenith is `up`.
    pub fn over(up: Vec3) -> Self {
        let up = up.try_normalize().unwrap_or(Vec3::Y);
        let side = up.any_orthonormal_vector();
        Self { up, sun: (up + 0.6 * side + 0.5 * up.cross(side)).normalize() }
    }

    /// What comes from the sky in a unit direction.
    pub fn sky(&self, dir: Vec3) -> Vec3 {
        let height = self.up.dot(dir);
        let (horizon, zenith) = (Vec3::new(0.75, 0.8, 0.85), Vec3::new(0.2, 0.38, 0.75));
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
