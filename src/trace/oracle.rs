//! Ray against triangle in double precision, with bounds on the errors of single precision: settles
//! disputes between tracers.
//!
//! The model is backward error: arithmetic in `f32` answers correctly for a triangle (or a box around it)
//! that is displaced by at most a few units in the last place of the coordinates involved. The oracle turns
//! this displacement into slacks of the distance along the ray and of the hit point within the triangle's
//! plane; both grow as rays graze the plane.

use crate::geometry::{Mesh, Ray};
use glam::DVec3;

/// Displacement, in units of `f32::EPSILON` times the largest coordinate difference between ray origin and
/// triangle plus the origin's largest coordinate, plus the error of a needle's normal.
pub const DISPLACEMENT_ULPS: f64 = 4.0;

/// Relative difference of distances that counts as equal.
pub const T_TOLERANCE: f64 = 1e-5;

/// How a ray meets a triangle, as exact as `f64` is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Ray parameter at which the ray crosses the triangle's plane.
    pub t: f64,
    /// Parameter's slack: how far `f32` may put it off. Infinite for rays in the plane.
    pub t_slack: f64,
    /// Distance of the crossing from the triangle's border, scene units, negative outside.
    pub inside: f64,
    /// Slack of `inside`: the half width of the edge band.
    pub slack: f64,
    /// The ray's interval.
    interval: [f64; 2],
}

impl Crossing {
    /// Of `ray` with triangle `prim`; `None` if there is no such triangle, or it or the ray has no extent.
    pub fn new(mesh: &Mesh, prim: u32, ray: &Ray) -> Option<Self> {
        if prim as usize >= mesh.len() {
            return None;
        }
        let [a, b, c] = mesh.corners(prim).map(|corner| corner.as_dvec3());
        let (org, dir) = (ray.org.as_dvec3(), ray.dir.as_dvec3());
        let length = dir.length();
        let (e1, e2) = (b - a, c - a);
        let cross = e1.cross(e2);
        let normal = cross.try_normalize()?;
        if length == 0.0 {
            return None;
        }
        let reach = [a, b, c].map(|corner| (corner - org).abs().max_element());
        let reach = reach[0].max(reach[1]).max(reach[2]) + org.abs().max_element();
        // The normal of a needle is a difference of products far larger than itself: its rounding tilts the
        // plane, which shifts the crossing by the tilt times the distance from the first corner.
        let tilt = e1.length() * e2.length() / cross.length();
        let arm = e1.length().max(e2.length());
        let displacement = DISPLACEMENT_ULPS * f64::from(f32::EPSILON) * (reach + tilt * arm);
        // The sine of the angle between ray and plane.
        let facing = normal.dot(dir) / length;
        let t = normal.dot(a - org) / (facing * length);
        let interval = [f64::from(ray.tnear.max(0.0)), f64::from(ray.tfar)];
        if !t.is_finite() {
            // In or beside the plane: neither hit nor missed for certain.
            let infinite = f64::INFINITY;
            return Some(Self { t: 0.0, t_slack: infinite, inside: 0.0, slack: infinite, interval });
        }
        let point = org + t * dir;
        Some(Self {
            t,
            t_slack: displacement / (facing.abs() * length),
            inside: border_distance(point, [a, b, c], normal),
            slack: displacement * (1.0 + (1.0 - facing * facing).max(0.0).sqrt() / facing.abs()),
            interval,
        })
    }

    /// True if `f32` arithmetic may report a hit at distance `t`.
    pub fn allows(&self, t: f32) -> bool {
        let off = (f64::from(t) - self.t).abs();
        self.is_possible() && off <= self.t_slack + T_TOLERANCE * self.t.abs()
    }

    /// True if `f32` arithmetic may report a hit.
    pub fn is_possible(&self) -> bool {
        self.inside >= -self.slack
            && self.t + self.t_slack >= self.interval[0]
            && self.t - self.t_slack <= self.interval[1]
    }

    /// True if `f32` arithmetic must report a hit: clear of the border and of the interval's ends.
    pub fn is_certain(&self) -> bool {
        self.inside > self.slack
            && self.t - self.t_slack > self.interval[0]
            && self.t + self.t_slack < self.interval[1]
    }
}

/// Distance of `point`, taken to lie in the triangle's plane, from the border; negative outside.
fn border_distance(point: DVec3, corners: [DVec3; 3], normal: DVec3) -> f64 {
    let mut within = f64::INFINITY;
    let mut outside = f64::INFINITY;
    for i in 0..3 {
        let (from, to) = (corners[i], corners[(i + 1) % 3]);
        let edge = to - from;
        let inward = normal.cross(edge).normalize_or_zero();
        within = within.min(inward.dot(point - from));
        let along = ((point - from).dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        outside = outside.min(point.distance(from + along * edge));
    }
    if within >= 0.0 { within } else { -outside }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn mesh() -> Mesh {
        let vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        Mesh::new(vertices, vec![[0, 1, 2], [0, 1, 1]]).unwrap().0
    }

    fn down(x: f32, y: f32) -> Ray {
        Ray { org: Vec3::new(x, y, 2.0), tnear: 0.0, dir: Vec3::NEG_Z, tfar: f32::INFINITY }
    }

    #[test]
    fn distances_from_the_border() {
        let mesh = mesh();
        let crossing = |x, y| Crossing::new(&mesh, 0, &down(x, y)).unwrap();
        assert!((crossing(0.25, 0.5).inside - 0.25f64 * 0.5f64.sqrt()).abs() < 1e-12);
        assert!((crossing(0.1, 0.5).inside - 0.1).abs() < 1e-6);
        assert!((crossing(-3.0, -4.0).inside + 5.0).abs() < 1e-12);
        assert_eq!(crossing(0.25, 0.25).t, 2.0);
    }

    #[test]
    fn verdicts_on_a_face_an_edge_and_beside() {
        let mesh = mesh();
        let judge = |ray: Ray| {
            let crossing = Crossing::new(&mesh, 0, &ray).unwrap();
            (crossing.is_possible(), crossing.is_certain())
        };
        assert_eq!(judge(down(0.25, 0.25)), (true, true));
        assert_eq!(judge(down(0.5, 0.5)), (true, false));
        assert_eq!(judge(down(-1e-7, 0.5)), (true, false));
        assert_eq!(judge(down(-1e-3, 0.5)), (false, false));
        assert_eq!(judge(Ray { tfar: 2.0, ..down(0.25, 0.25) }), (true, false));
        assert_eq!(judge(Ray { tfar: 1.9, ..down(0.25, 0.25) }), (false, false));
        assert_eq!(judge(Ray { tnear: 2.1, ..down(0.25, 0.25) }), (false, false));
        let beside = Ray { dir: Vec3::X, ..down(0.25, 0.25) };
        assert_eq!(judge(beside), (true, false), "parallel rays are never certain");
        assert!(Crossing::new(&mesh, 1, &down(0.25, 0.25)).is_none());
        assert!(Crossing::new(&mesh, 2, &down(0.25, 0.25)).is_none());
        assert!(Crossing::new(&mesh, 0, &Ray { dir: Vec3::ZERO, ..down(0.0, 0.0) }).is_none());
    }
}
