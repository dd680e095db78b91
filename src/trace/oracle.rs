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
//! certain. In Embree's arithmetic, and so in our kernel's, its normal is not zero: by fused multiplication it is the
//! rounding error of a product, and the distance of a hit is a quotient of two such errors. A distance near the
//! segment's is explained by rounded coordinates, any other as the error on a thin triangle, here without bound.

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
    /// rounding tilts the plane. The error grows with the triangle's aspect. Without any area nothing bounds the
    /// distance along the ray; how far the ray may pass from the triangle does not grow.
    ThinTriangles,
}

/// Relative difference of distances that counts as equal.
pub const T_TOLERANCE: f64 = 1e-5;

/// How a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Ray parameter at which the ray crosses the triangle's plane, or is nearest to a triangle of no area.
    pub t: f64,
    /// Parameter's slack: how far `f32` may put it off. Infinite for rays in the plane.
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
        if twice_area <= NO_AREA * lengths[0] * lengths[1] {
            return Some(Self::without_area(corners, (org, dir), interval, of_coordinates * reach, model));
        }
        // A tilted plane shifts the crossing by the tilt times the distance from the first corner.
        let of_normal = match model {
            Model::RoundedCoordinates => 0.0,
            Model::ThinTriangles => lengths[0] * lengths[1] / twice_area * lengths[0].max(lengths[1]),
        };
        let displacement = of_coordinates * (reach + of_normal);
        let approach = extended::dot(normal, dir);
        // The sine of the angle between ray and plane.
        let facing = approach.value() / (twice_area * length);
        let t = extended::dot(normal, from_org[0]) / approach;
        if !t.value().is_finite() {
            // In or beside the plane: neither hit nor missed for certain.
            let infinite = f64::INFINITY;
            return Some(Self { t: 0.0, t_slack: infinite, inside: 0.0, slack: infinite, interval });
        }
        Some(Self {
            t: t.value(),
            t_slack: displacement / (facing.abs() * length),
            inside: border_distance(extended::along(org, t, dir), corners, normal),
            slack: grown(displacement, facing.abs()),
            interval,
        })
    }

    /// With a triangle of no area, whose corners may be displaced by `displacement`.
    fn without_area(
        corners: [Vector; 3],
        (org, dir): (Vector, Vector),
        interval: [f64; 2],
        displacement: f64,
        model: Model,
    ) -> Self {
        let segment = Segment::longest(corners);
        let (t, distance) = segment.nearest(org, dir, interval);
        // The angle with the segment has the place of that with a plane.
        let sine = segment.sine(dir);
        Self {
            t,
            t_slack: match model {
                Model::RoundedCoordinates => displacement / (sine * extended::rounded(dir).length()),
                Model::ThinTriangles => f64::INFINITY,
            },
            inside: -distance,
            slack: grown(displacement, sine),
            interval,
        }
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
mod tests {
    use super::*;

    fn mesh() -> Mesh {
        let vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        Mesh::new(vertices, vec![[0, 1, 2], [0, 1, 1]]).unwrap().0
    }

    fn down(x: f32, y: f32) -> Ray {
        Ray { org: Vec3::new(x, y, 2.0), tnear: 0.0, dir: Vec3::NEG_Z, tfar: f32::INFINITY }
    }

    fn of(mesh: &Mesh, prim: u32, ray: &Ray) -> Option<Crossing> {
        Crossing::new(mesh, prim, ray, Model::RoundedCoordinates)
    }

    /// A thousand long and a hundred thousandth wide; the ray goes through its middle.
    #[test]
    fn a_thin_triangle_has_no_wider_band_than_another() {
        let at = |x: f32| [1000.0 * x, 1000.0 * x, 0.0];
        let vertices = vec![at(0.0), at(1.0), [500.0, 500.02, 0.0]];
        let thin = Mesh::new(vertices, vec![[0, 1, 2]]).unwrap().0;
        let down = down(500.0, 500.007);
        let exact = of(&thin, 0, &down).unwrap();
        assert!((exact.inside - 0.005).abs() < 1e-4 && exact.slack < 1e-3, "{exact:?}");
        assert!(exact.is_certain());
        assert!((exact.t - 2.0).abs() < 1e-12);
        let single = Crossing::new(&thin, 0, &down, Model::ThinTriangles).unwrap();
        assert!(!single.is_certain() && single.slack > exact.slack && single.inside == exact.inside);
    }

    #[test]
    fn distances_from_the_border() {
        let mesh = mesh();
        let crossing = |x, y| of(&mesh, 0, &down(x, y)).unwrap();
        assert!((crossing(0.25, 0.5).inside - 0.25f64 * 0.5f64.sqrt()).abs() < 1e-12);
        assert!((crossing(0.1, 0.5).inside - 0.1).abs() < 1e-6);
        assert!((crossing(-3.0, -4.0).inside + 5.0).abs() < 1e-12);
        assert_eq!(crossing(0.25, 0.25).t, 2.0);
    }

    #[test]
    fn verdicts_on_a_face_an_edge_and_beside() {
        let mesh = mesh();
        let judge = |ray: Ray| {
            let crossing = of(&mesh, 0, &ray).unwrap();
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
        assert!(!of(&mesh, 1, &down(0.25, 0.25)).unwrap().is_possible());
        assert!(of(&mesh, 2, &down(0.25, 0.25)).is_none());
        assert!(of(&mesh, 0, &Ray { dir: Vec3::ZERO, ..down(0.0, 0.0) }).is_none());
    }

    /// Along z, 8192 long, two equal corners: what a fuzzer found.
    fn segment() -> Mesh {
        let vertices = vec![[1.8e-4; 3], [2.4e-12, 6e-33, 8192.0]];
        Mesh::new(vertices, vec![[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0], [1, 1, 1]]).unwrap().0
    }

    /// Meets the middle of [`segment`] at a parameter of 8192.
    fn through_its_middle() -> Ray {
        let (middle, dir) = (Vec3::new(9e-5, 9e-5, 4096.0), Vec3::new(2.0, 2.0, -1.2));
        Ray { org: middle - 8192.0 * dir, tnear: 0.0, dir, tfar: f32::INFINITY }
    }

    #[test]
    fn without_area_a_hit_on_the_segment_is_possible_and_none_is_certain() {
        let (mesh, ray) = (segment(), through_its_middle());
        for prim in 0..3 {
            let exact = of(&mesh, prim, &ray).unwrap();
            assert!(exact.allows(8192.0) && !exact.allows(4778.7) && !exact.is_certain(), "{exact:?}");
            // The kernel's answer, 4778.7: a distance that is rounding error alone.
            let single = Crossing::new(&mesh, prim, &ray, Model::ThinTriangles).unwrap();
            assert!(single.allows(8192.0) && single.allows(4778.7) && !single.is_certain(), "{single:?}");
            // As for an edge: less than a millionth of the coordinates.
            assert!(exact.slack == single.slack && exact.slack < 0.05, "{exact:?}");
        }
        // Another corner between, all three in a line, exactly.
        let line = vec![[0.0; 3], [1.0, 2.0, 3.0], [3.0, 6.0, 9.0]];
        let line = Mesh::new(line, vec![[0, 1, 2], [1, 2, 0], [2, 0, 1]]).unwrap().0;
        for prim in 0..3 {
            let at = |z: f32| Ray { org: Vec3::new(z / 3.0, 0.0, z), dir: Vec3::Y, ..ray };
            let judge = |z| of(&line, prim, &at(z)).unwrap().is_possible();
            assert_eq!([-0.1, 0.0, 1.5, 6.0, 9.0, 9.1].map(judge), [false, true, true, true, true, false]);
        }
    }

    #[test]
    fn without_area_a_hit_beside_the_segment_is_impossible() {
        let (mesh, ray) = (segment(), through_its_middle());
        // Across ray and segment.
        let aside = |by: f32| Ray { org: ray.org + by * Vec3::new(0.5, -0.5, 0.0).normalize(), ..ray };
        let beyond = Ray { org: ray.org + Vec3::new(0.0, 0.0, 4096.0 + 82.0), ..ray };
        let [before, behind] = [Ray { tfar: 8100.0, ..ray }, Ray { tnear: 8300.0, ..ray }];
        for model in [Model::RoundedCoordinates, Model::ThinTriangles] {
            for prim in 0..3 {
                let is_possible = |ray: &Ray| Crossing::new(&mesh, prim, ray, model).unwrap().is_possible();
                assert!(is_possible(&aside(0.001)));
                assert!(![aside(82.0), aside(-82.0), beyond, before, behind].iter().any(is_possible));
            }
        }
        let along = Ray { org: Vec3::new(9e-5, 9e-5, -100.0), dir: Vec3::Z, ..ray };
        assert!(of(&mesh, 0, &along).is_some_and(|along| along.is_possible() && !along.is_certain()));
    }

    #[test]
    fn a_point_is_met_within_rounding_of_it() {
        let mesh = segment();
        let [x, y, z] = mesh.vertices()[1];
        let at = |by: f32| Ray { org: Vec3::new(x + by, y, z + 100.0), ..down(0.0, 0.0) };
        for model in [Model::RoundedCoordinates, Model::ThinTriangles] {
            let crossing = |by: f32| Crossing::new(&mesh, 4, &at(by), model).unwrap();
            let met = crossing(0.0);
            assert!(met.allows(100.0) && !met.is_certain() && !crossing(1.0).is_possible());
            assert!(!Crossing::new(&mesh, 3, &at(0.0), model).unwrap().is_certain());
        }
    }
}
