//! The pinhole camera.

use crate::geometry::Ray;
use crate::scene::View;
use glam::Vec3;

/// A [`View`] over an image of some size, ready to make rays. Total: a degenerate view (no distance to the
/// target, `up` along the line of sight) gets an arbitrary orientation, not NaNs.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    eye: Vec3,
    forward: Vec3,
    right: Vec3,
    up: Vec3,
    /// Half the image plane's width and height at distance 1.
    half: [f32; 2],
    size: [f32; 2],
}

impl Camera {
    /// The camera of `view` over `width` x `height` pixels.
    pub fn new(view: &View, width: u32, height: u32) -> Self {
        // Of points that are very near or far the squares leave the range of f32.
        let in_double =
            || (view.target.as_dvec3() - view.eye.as_dvec3()).try_normalize().map(|v| v.as_vec3());
        let forward = (view.target - view.eye).try_normalize().or_else(in_double).unwrap_or(Vec3::NEG_Z);
        let right = forward
            .cross(view.up.normalize_or_zero())
            .try_normalize()
            .unwrap_or_else(|| forward.any_orthonormal_vector());
        let size = [width.max(1) as f32, height.max(1) as f32];
        let half_height = (0.5 * view.fov_y_deg.clamp(1.0, 179.0)).to_radians().tan();
        Self {
            eye: view.eye,
            forward,
            right,
            up: right.cross(forward),
            half: [half_height * size[0] / size[1], half_height],
            size,
        }
    }

    /// The ray through pixel (`x`, `y`), counted from the upper left corner, at `jitter` in [0, 1)² within it.
    pub fn ray(&self, x: u32, y: u32, jitter: [f32; 2]) -> Ray {
        let across = ((x as f32 + jitter[0]) / self.size[0] * 2.0 - 1.0) * self.half[0];
        let down = ((y as f32 + jitter[1]) / self.size[1] * 2.0 - 1.0) * self.half[1];
        let dir = (self.forward + across * self.right - down * self.up).normalize();
        Ray { org: self.eye, tnear: 0.0, dir, tfar: f32::INFINITY }
    }

    /// Unit vectors to the right, upwards and along the line of sight.
    pub fn axes(&self) -> [Vec3; 3] {
        [self.right, self.up, self.forward]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: View =
        View { eye: Vec3::new(0.0, 0.0, 5.0), target: Vec3::ZERO, up: Vec3::Y, fov_y_deg: 90.0 };

    #[test]
    fn corners_look_where_they_should() {
        let camera = Camera::new(&VIEW, 200, 100);
        let centre = camera.ray(100, 50, [0.0; 2]);
        assert!((centre.dir - Vec3::NEG_Z).length() < 1e-6);
        let upper_left = camera.ray(0, 0, [0.0; 2]).dir;
        let expected = Vec3::new(-2.0, 1.0, -1.0).normalize();
        assert!((upper_left - expected).length() < 1e-6, "{upper_left}");
    }

    #[test]
    fn every_view_that_is_accepted_is_looked_at() {
        let wide = Camera::new(&View { fov_y_deg: 179.0, ..VIEW }, 1, 1).ray(0, 0, [0.5, 0.0]).dir;
        assert!((wide.angle_between(Vec3::NEG_Z).to_degrees() - 89.5).abs() < 0.01, "{wide}");
        let near = View { eye: Vec3::ZERO, target: 1e-23 * Vec3::X, ..VIEW };
        assert_eq!(near.check(), Ok(()));
        assert!((Camera::new(&near, 1, 1).axes()[2] - Vec3::X).length() < 1e-6);
    }

    #[test]
    fn degenerate_views_give_valid_rays() {
        for view in [
            View { target: VIEW.eye, ..VIEW },
            View { up: Vec3::Z, ..VIEW },
            View { up: Vec3::ZERO, ..VIEW },
            View { fov_y_deg: 0.0, ..VIEW },
            View { fov_y_deg: 360.0, ..VIEW },
        ] {
            assert!(Camera::new(&view, 0, 3).ray(0, 1, [0.5; 2]).is_valid());
        }
    }
}
