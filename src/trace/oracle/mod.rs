//! Ray against triangle in extended precision (`double_double`), with bounds on the errors of single precision:
//! settles disputes between tracers.
//!
//! The model is backward error: arithmetic in `f32` answers correctly for a triangle (or a box around it)
//! that is displaced by at most a few units in the last place of the coordinates involved. The oracle turns
//! this displacement into slacks of the distance along the ray and of the hit point within the triangle's
//! plane; both grow as rays graze the plane. They do not grow as triangles get thin: what single precision gets wrong
//! there is wrong, and counted as a near miss ([`Model::ThinTriangles`]).
//!
//! A triangle of no area is a segment, its longest edge, or a point. Strictly no ray hits it, but displaced corners
//! span a triangle about the segment: a ray that passes it within the slack of an edge may hit or miss, never for
//! certain.
//!
//! In Embree's arithmetic, and so in our kernel's, the determinant of such a triangle (its normal times the direction)
//! need not be zero: by fused multiplication, or over edges that were rounded, it is a rounding error. What is compared
//! with it are two products of an edge and `(corner - origin) x direction`, which both vanish where the ray meets the
//! line of the edges, beyond their ends as well; the distance is a quotient of two errors. So a kernel may report a hit
//! wherever the ray passes that line, at any distance. That holds for triangles with an area, too, as long as the
//! determinant is no larger than its own rounding error. Rounded coordinates explain a hit at the segment; any other
//! one near the line is the error on a thin triangle, which has no bound along the line or the ray.

use super::double_double::{self as extended, Vector};
use super::segment::Segment;
use crate::geometry::{Mesh, Ray};
use glam::Vec3;

/// Displacement, in units of `f32::EPSILON` times the largest coordinate difference between ray origin and
/// triangle plus the origin's largest coordinate.
pub const DISPLACEMENT_ULPS: f64 = 4.0;

/// A doubled area below this share of two edges' product is none: errors of 106 bits are not far below it.
const NO_AREA: f64 = 1e-29;

/// Which errors of single precision are allowed for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// Rounded coordinates.
    RoundedCoordinates,
    /// That, and the computed normal of a thin triangle: a difference of products far larger than itself, whose
    /// rounding tilts the plane. The error grows with the triangle's aspect. Where the determinant is lost in it, the
    /// triangle is the line of its longest edge: nothing bounds the distance along the ray or the place on the line;
    /// how far the ray may pass from the line does not grow.
    ThinTriangles,
}

/// Relative difference of distances that counts as equal.
pub const T_TOLERANCE: f64 = 1e-5;

/// How a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Ray parameter at which the ray crosses the triangle's plane, or is nearest to what a triangle of no area is.
    pub t: f64,
    /// Parameter's slack: how far `f32` may put it off. Infinite for rays in the plane, and for lines.
    pub t_slack: f64,
    /// Distance of the crossing from the triangle's border, scene units, negative outside. Without area: of the ray
    /// from the triangle, never positive.
    pub inside: f64,
    /// Slack of `inside`: the half width of the edge band.
    pub slack: f64,
    /// The ray's interval.
    interval: [f64; 2],
}

impl Crossing {
    /// Of `ray` with triangle `prim`; `None` if there is no such triangle, or the ray has no direction.
    pub fn new(mesh: &Mesh, prim: u32, ray: &Ray, model: Model) -> Option<Self> {
        if prim as usize >= mesh.len() {
            return None;
        }
        let vector = |v: Vec3| -> Vector { v.to_array().map(Into::into) };
        let corners = mesh.corners(prim).map(|corner| vector(corner.into()));
        let (org, dir) = (vector(ray.org), vector(ray.dir));
        let edge = |to: usize| extended::difference(corners[to], corners[0]);
        let normal = extended::cross(edge(1), edge(2));
        let (length, twice_area) = (ray.dir.as_dvec3().length(), extended::rounded(normal).length());
        if length == 0.0 {
            return None;
        }
        let from_org = corners.map(|corner| extended::difference(corner, org));
        let reach = from_org.map(|to| extended::rounded(to).abs().max_element());
        let reach = reach[0].max(reach[1]).max(reach[2]) + ray.org.as_dvec3().abs().max_element();
        let lengths = [1, 2].map(|to| extended::rounded(edge(to)).length());
        let of_coordinates = DISPLACEMENT_ULPS * f64::from(f32::EPSILON);
        let interval = [f64::from(ray.tnear.max(0.0)), f64::from(ray.tfar)];
        let (product, longest) = (lengths[0] * lengths[1], lengths[0].max(lengths[1]));
        let as_line = || {
            // Rounding errors of the products, and of the determinant that they are compared with.
            let displacement = 2.0 * of_coordinates * (reach + longest);
            Self::with_line(&Segment::longest(corners), (org, dir), interval, displacement)
        };
        if twice_area <= NO_AREA * product {
            return Some(match model {
                Model::RoundedCoordinates => {
                    let segment = Segment::longest(corners);
                    Self::with_segment(&segment, (org, dir), interval, of_coordinates * reach)
                }
                Model::ThinTriangles => as_line(),
            });
        }
        let approach = extended::dot(normal, dir);
        // The sine of the angle between ray and plane.
        let facing = approach.value() / (twice_area * length);
        let t = extended::dot(normal, from_org[0]) / approach;
        if !t.value().is_finite() {
            // In or beside the plane: neither hit nor missed for certain.
            let infinite = f64::INFINITY;
            return Some(Self { t: 0.0, t_slack: infinite, inside: 0.0, slack: infinite, interval });
        }
        // Edges, products and differences are rounded: of this, the computed one errs by 2.3 `f32::EPSILON` at most.
        let of_determinant = of_coordinates * product * length;
        if model == Model::ThinTriangles && approach.value().abs() <= of_determinant {
            return Some(as_line());
        }
        let point = extended::along(org, t, dir);
        // A tilted plane shifts the crossing by the tilt times the distance from the first corner.
        let of_normal = match model {
            Model::RoundedCoordinates => 0.0,
            Model::ThinTriangles => {
                let from_first = extended::rounded(extended::difference(point, corners[0])).length();
                product / twice_area * longest.max(from_first)
            }
        };
        let displacement = of_coordinates * (reach + of_normal);
        Some(Self {
            t: t.value(),
            t_slack: displacement / (facing.abs() * length),
            inside: border_distance(point, corners, normal),
            slack: grown(displacement, facing.abs()),
            interval,
        })
    }

    /// With a triangle of no area, whose corners may be displaced by `displacement`.
    fn with_segment(
        segment: &Segment,
        (org, dir): (Vector, Vector),
        interval: [f64; 2],
        displacement: f64,
    ) -> Self {
        let (t, distance) = segment.nearest(org, dir, interval);
        // The angle with the segment has the place of that with a plane.
        let sine = segment.sine(dir);
        Self {
            t,
            t_slack: displacement / (sine * extended::rounded(dir).length()),
            inside: -distance,
            slack: grown(displacement, sine),
            interval,
        }
    }

    /// With a triangle whose computed determinant is a rounding error: a ray may hit it where it passes within
    /// `displacement` of the segment's line, and at any distance, also where that of the line is not in the interval.
    fn with_line(
        segment: &Segment,
        (org, dir): (Vector, Vector),
        interval: [f64; 2],
        displacement: f64,
    ) -> Self {
        let (t, distance) = segment.line_nearest(org, dir);
        let slack = grown(displacement, segment.sine(dir));
        Self { t, t_slack: f64::INFINITY, inside: -distance, slack, interval }
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

/// The slack of a distance across a ray that meets what is displaced at an angle of this sine.
fn grown(displacement: f64, sine: f64) -> f64 {
    displacement * (1.0 + (1.0 - sine * sine).max(0.0).sqrt() / sine)
}

/// Distance of `point`, taken to lie in the triangle's plane, from the border; negative outside.
fn border_distance(point: Vector, corners: [Vector; 3], normal: Vector) -> f64 {
    let mut within = f64::INFINITY;
    let mut outside = f64::INFINITY;
    for i in 0..3 {
        let (start, end) = (corners[i], corners[(i + 1) % 3]);
        let edge = extended::difference(end, start);
        let from_corner = extended::difference(point, start);
        let inward = extended::cross(normal, edge);
        let distance = extended::dot(inward, from_corner).value() / extended::rounded(inward).length();
        within = within.min(distance);
        outside = outside.min(Segment::new(start, end).distance(point));
    }
    if within >= 0.0 { within } else { -outside }
}

#[cfg(test)]
mod tests;
