//! Cameras: given in a `views.json`, or placed around the geometry.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use crate::geometry::{Mesh, Ray};
use glam::Vec3;

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct View {
    /// Position, scene units.
    pub eye: Vec3,
    /// Point looked at.
    pub target: Vec3,
    /// Up direction, not parallel to the line of sight.
    pub up: Vec3,
    /// Vertical field of view, degrees.
    pub fov_y_deg: f32,
}

/// A camera that cannot render an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InvalidView {
    /// A coordinate is NaN, infinite or beyond [`Ray::LARGEST`].
    #[error("eye, target or up is not finite or too large")]
    Position,
    /// Eye and target are the same point.
    #[error("eye and target coincide")]
    Direction,
    /// The up direction is zero or along the line of sight.
    #[error("up is zero or parallel to the line of sight")]
    Up,
    /// The field of view is outside 1 to 179 degrees.
    #[error("fov_y_deg is not within 1 to 179 degrees")]
    FieldOfView,
}

impl View {
    /// Checks that the camera can render an image.
    ///
    /// # Errors
    /// [`InvalidView`], the first that applies.
    pub fn check(&self) -> Result<(), InvalidView> {
        let usable = |v: Vec3| v.abs().cmplt(Vec3::splat(Ray::LARGEST)).all();
        if !(usable(self.eye) && usable(self.target) && usable(self.up)) {
            return Err(InvalidView::Position);
        }
        // In double precision: the squares of large or tiny coordinates leave the range of f32.
        let forward = (self.target.as_dvec3() - self.eye.as_dvec3()).normalize_or_zero();
        if forward == glam::DVec3::ZERO {
            return Err(InvalidView::Direction);
        }
        if forward.cross(self.up.as_dvec3().normalize_or_zero()).length() < 1e-4 {
            return Err(InvalidView::Up);
        }
        if !(1.0..=179.0).contains(&self.fov_y_deg) {
            return Err(InvalidView::FieldOfView);
        }
        Ok(())
    }
}

/// Directions from the target to the eye: azimuth and elevation, degrees.
const AROUND: [[f64; 2]; 3] = [[35.0, 20.0], [150.0, 40.0], [265.0, 10.0]];
/// Field of view of the cameras around a scene, degrees.
const FIELD_OF_VIEW: f64 = 45.0;
/// Margin around the geometry in the image, as a factor.
const MARGIN: f64 = 1.05;

/// Three cameras outside that each see all of the geometry, from different sides and heights. Y is up, or Z
/// where the scene is less than half as high in Z as along either other axis, as terrains and buildings with
/// Z up are. An interior without openings is seen from outside only: give such scenes a `views.json`.
pub fn views_around(mesh: &Mesh) -> Vec<View> {
    around(mesh, None)
}

/// The same, with the axis that the scene's format calls up, if it does.
pub(super) fn around(mesh: &Mesh, up: Option<Vec3>) -> Vec<View> {
    let bounds = mesh.bounds();
    let bounds = if bounds.is_empty() {
        crate::geometry::Aabb::new(Default::default(), Default::default())
    } else {
        bounds
    };
    let (min, max) = (glam::Vec3::from(bounds.min).as_dvec3(), glam::Vec3::from(bounds.max).as_dvec3());
    let (center, half) = ((min + max) / 2.0, (max - min) / 2.0);
    let z_up = up.map_or(half.z < 0.5 * half.x.min(half.y), |up| up == Vec3::Z);
    let up = if z_up { glam::DVec3::Z } else { glam::DVec3::Y };
    let (side, front) =
        if z_up { (glam::DVec3::X, -glam::DVec3::Y) } else { (glam::DVec3::X, glam::DVec3::Z) };

    // A point, or a speck far from the origin, still gets a distance that f32 can express.
    let smallest = (center.abs().max_element() * 1e-4).max(1e-15);
    let largest = f64::from(Ray::LARGEST) * 0.99;
    let view = |[azimuth, elevation]: [f64; 2]| {
        let (sin, cos) = azimuth.to_radians().sin_cos();
        let (sin_up, cos_up) = elevation.to_radians().sin_cos();
        let back = (side * sin + front * cos) * cos_up + up * sin_up;
        let right = up.cross(back).normalize();
        let above = back.cross(right);
        let tangent = (FIELD_OF_VIEW / 2.0).to_radians().tan();
        // The corner that needs the greatest distance decides; images are taken to be square.
        let distance = (0..8)
            .map(|corner| {
                let sign = |axis: u32| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
                let corner = half * glam::DVec3::new(sign(0), sign(1), sign(2));
                corner.dot(back) + corner.dot(right).abs().max(corner.dot(above).abs()) / tangent
            })
            .fold(smallest, f64::max);
        let eye = center + back * distance * MARGIN;
        View {
            eye: eye.clamp(glam::DVec3::splat(-largest), glam::DVec3::splat(largest)).as_vec3(),
            target: center.as_vec3(),
            up: up.as_vec3(),
            fov_y_deg: FIELD_OF_VIEW as f32,
        }
    };
    AROUND.map(view).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(vertices: Vec<[f32; 3]>) -> Vec<View> {
        let triangles = (0..vertices.len() as u32).map(|i| [i, 0, 1]).collect();
        let views = views_around(&Mesh::new(vertices, triangles).unwrap().0);
        assert_eq!(views.len(), 3);
        for view in &views {
            assert_eq!(view.check(), Ok(()), "{view:?}");
        }
        views
    }

    #[test]
    fn any_geometry_has_cameras_around_it() {
        around(vec![]);
        around(vec![[0.0; 3]; 3]);
        around(vec![[1e6, -3.0, 2.0]; 3]);
        around(vec![[0.0; 3], [1e-20, 0.0, 0.0], [0.0, 1e-20, 0.0]]);
        around(vec![[-1.8e18; 3], [1.8e18; 3], [0.0; 3]]);
        around(vec![[1e18; 3], [1.000_01e18, 1e18, 1e18], [1e18; 3]]);
    }

    #[test]
    fn the_low_axis_is_up() {
        let corner = |x, y, z| around(vec![[0.0; 3], [x, y, z], [x, 0.0, 0.0]])[0].up;
        assert_eq!(corner(9.0, 8.0, 2.0), Vec3::Z);
        assert_eq!(corner(9.0, 2.0, 8.0), Vec3::Y);
        assert_eq!(corner(1.0, 1.0, 1.0), Vec3::Y);
        assert_eq!(corner(1.0, 1.0, 0.0), Vec3::Z);
    }

    #[test]
    fn all_corners_are_in_the_picture() {
        for view in around(vec![[0.0; 3], [4.0, 1.0, 30.0], [4.0, 0.0, 0.0]]) {
            let back = (view.eye - view.target).normalize();
            for i in 0..8 {
                let corner = Vec3::new((i & 1) as f32 * 4.0, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32 * 30.0);
                let to = corner - view.eye;
                let (depth, right) = (-to.dot(back), view.up.cross(back).normalize());
                let reach = to.dot(right).abs().max(to.dot(back.cross(right)).abs());
                assert!(depth > 0.0 && reach <= depth * (view.fov_y_deg / 2.0).to_radians().tan());
            }
        }
    }

    #[test]
    fn blind_cameras_are_found() {
        let view = View { eye: Vec3::ZERO, target: Vec3::X, up: Vec3::Y, fov_y_deg: 45.0 };
        assert_eq!(view.check(), Ok(()));
        assert_eq!(View { up: -Vec3::X, ..view }.check(), Err(InvalidView::Up));
        assert_eq!(View { target: Vec3::ZERO, ..view }.check(), Err(InvalidView::Direction));
        assert_eq!(View { eye: Vec3::NAN, ..view }.check(), Err(InvalidView::Position));
        assert_eq!(View { fov_y_deg: f32::NAN, ..view }.check(), Err(InvalidView::FieldOfView));
    }
}
