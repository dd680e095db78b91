//! A pinhole camera.

use phr::geometry::Ray;
use phr::glam::Vec3;
use phr::scene::View;

pub struct Camera {
    eye: Vec3,
    /// Direction to the upper left corner of the picture, and one pixel across and down.
    corner: Vec3,
    across: Vec3,
    down: Vec3,
}

impl Camera {
    pub fn new(view: &View, width: u32, height: u32) -> Self {
        let forward = (view.target - view.eye).normalize();
        let right = forward.cross(view.up).try_normalize().unwrap_or(forward.any_orthonormal_vector());
        let half = (0.5 * view.fov_y_deg).to_radians().tan();
        let pixel = 2.0 * half / height as f32;
        let (across, down) = (pixel * right, -pixel * right.cross(forward));
        let corner = forward - 0.5 * (width as f32 * across + height as f32 * down);
        Self { eye: view.eye, corner, across, down }
    }

    /// The ray through a point of the picture, in pixels from its upper left corner.
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let dir = (self.corner + x * self.across + y * self.down).normalize();
        Ray::new(self.eye, dir)
    }
}
