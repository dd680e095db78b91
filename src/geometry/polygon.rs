//! Triangles clipped to boxes (Sutherland-Hodgman), in double precision: for EPO and for validation.

use super::Aabb;
use glam::{DVec3, Vec3A};

/// A convex planar polygon: a triangle after up to six cuts.
#[derive(Clone, Copy, Debug)]
pub struct Polygon {
    corners: [DVec3; 9],
    len: usize,
}

impl Polygon {
    /// The whole triangle.
    pub fn triangle(corners: [Vec3A; 3]) -> Self {
        let mut polygon = Self { corners: [DVec3::ZERO; 9], len: 3 };
        for (to, from) in polygon.corners.iter_mut().zip(corners) {
            *to = from.as_dvec3();
        }
        polygon
    }

    /// The part inside `bounds`.
    #[must_use]
    pub fn clipped(mut self, bounds: Aabb) -> Self {
        for axis in 0..3 {
            self.cut(axis, f64::from(bounds.min[axis]), 1.0);
            self.cut(axis, f64::from(bounds.max[axis]), -1.0);
        }
        self
    }

    /// True if all of it is inside `bounds`: clipping would change nothing.
    pub fn is_inside(&self, bounds: Aabb) -> bool {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        self.corners[..self.len].iter().all(|corner| (corner.cmpge(min) & corner.cmple(max)).all())
    }

    /// Keeps the part where `sign * (x[axis] - plane) >= 0`.
    fn cut(&mut self, axis: usize, plane: f64, sign: f64) {
        let input = *self;
        self.len = 0;
        for i in 0..input.len {
            let (a, b) = (input.corners[i], input.corners[(i + 1) % input.len]);
            let (da, db) = (sign * (a[axis] - plane), sign * (b[axis] - plane));
            if da >= 0.0 {
                self.push(a);
            }
            if (da < 0.0) != (db < 0.0) {
                let mut crossing = a + (b - a) * (da / (da - db));
                crossing[axis] = plane;
                self.push(crossing);
            }
        }
    }

    fn push(&mut self, corner: DVec3) {
        // Rounding can produce a tenth corner of a sliver; it adds no area.
        if self.len < self.corners.len() {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    /// The smallest box in single precision; empty if nothing is left.
    pub fn bounds(&self) -> Aabb {
        let corners = &self.corners[..self.len];
        let min = corners.iter().fold(DVec3::INFINITY, |a, &b| a.min(b));
        let max = corners.iter().fold(DVec3::NEG_INFINITY, |a, &b| a.max(b));
        let below = |x: f64| if f64::from(x as f32) > x { (x as f32).next_down() } else { x as f32 };
        let above = |x: f64| if f64::from(x as f32) < x { (x as f32).next_up() } else { x as f32 };
        Aabb::new(Vec3A::from(min.to_array().map(below)), Vec3A::from(max.to_array().map(above)))
    }

    /// Area, 0 for fewer than three corners.
    pub fn area(&self) -> f64 {
        let Some((first, rest)) = self.corners[..self.len].split_first() else { return 0.0 };
        let twice: DVec3 = rest.windows(2).map(|w| (w[0] - *first).cross(w[1] - *first)).sum();
        0.5 * twice.length()
    }

    /// True if nothing is left.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_of_a_triangle_add_up() {
        let triangle =
            Polygon::triangle([Vec3A::ZERO, Vec3A::new(4.0, 0.0, 1.0), Vec3A::new(1.0, 3.0, -2.0)]);
        let space = Aabb::new(Vec3A::splat(-10.0), Vec3A::splat(10.0));
        assert_eq!(triangle.clipped(space).area(), triangle.area());
        assert!(triangle.is_inside(space) && !triangle.is_inside(Aabb { max: Vec3A::ONE, ..space }));
        let (mut left, mut right) = (space, space);
        left.max.x = 1.5;
        right.min.x = 1.5;
        let sum = triangle.clipped(left).area() + triangle.clipped(right).area();
        assert!((sum - triangle.area()).abs() < 1e-12);
        right.min.x = 5.0;
        assert!(triangle.clipped(right).is_empty());
    }
}
