//! Splitting a reference to a triangle by a plane (Stich et al. 2009, reference splitting): each side gets the
//! box of the triangle's own part there, not half of the reference's box.

use crate::geometry::{Aabb, Mesh, Polygon};
use glam::{DVec3, Vec3A};

/// The boxes of a triangle's parts inside `bounds` left and right of `plane`, either of which may be
/// empty. Together they cover that part: crossings are rounded outwards.
///
/// Earlier cuts are known by `bounds` alone, so that after several cuts along different axes a box may be
/// larger than its part; never smaller, and never larger than `bounds`.
#[inline]
pub(crate) fn split_triangle(corners: &[Vec3A; 3], bounds: Aabb, axis: usize, plane: f32) -> [Aabb; 2] {
    let (mut left, mut right) = (Aabb::EMPTY, Aabb::EMPTY);
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if a[axis] <= plane {
            left = left.grow(a);
        }
        if a[axis] >= plane {
            right = right.grow(a);
        }
        if (a[axis] < plane && plane < b[axis]) || (b[axis] < plane && plane < a[axis]) {
            let crossing = crossing(a.as_dvec3(), b.as_dvec3(), axis, f64::from(plane));
            left = left.union(crossing);
            right = right.union(crossing);
        }
    }
    [left.below(axis, plane).intersection(bounds), right.above(axis, plane).intersection(bounds)]
}

/// A box around the point where the edge from `a` to `b` crosses the plane.
fn crossing(a: DVec3, b: DVec3, axis: usize, plane: f64) -> Aabb {
    let point = a + (b - a) * ((plane - a[axis]) / (b[axis] - a[axis]));
    // More than the rounding of the line above, and far less than a unit in the last place of f32.
    let slack = a.abs().max(b.abs()) * (8.0 * f64::EPSILON);
    Aabb::new(
        Vec3A::from_array((point - slack).to_array().map(|x| (x as f32).next_down())),
        Vec3A::from_array((point + slack).to_array().map(|x| (x as f32).next_up())),
    )
}

/// The box of the part of triangle `prim` inside `bounds`; none if they do not meet.
pub(crate) fn visible(mesh: &Mesh, prim: u32, bounds: Aabb) -> Option<Aabb> {
    let corners = mesh.corners(prim);
    let whole = Aabb::of_triangle(corners);
    if bounds.contains(whole) {
        return Some(whole);
    }
    // A part that touches a face from outside, within rounding, stays on both sides.
    let slack = bounds.min.abs().max(bounds.max.abs()) * (4.0 * f32::EPSILON);
    let grown = Aabb::new(bounds.min - slack, bounds.max + slack);
    let part = Polygon::triangle(corners).clipped(grown).bounds().intersection(bounds);
    (!part.is_empty()).then_some(part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_of_a_diagonal_are_quarters_of_its_box() {
        let corners = [Vec3A::ZERO, Vec3A::new(4.0, 8.0, 0.0), Vec3A::new(4.0, 8.0, 0.0)];
        let [left, right] = split_triangle(&corners, Aabb::of_triangle(corners), 0, 1.0);
        let near = |a: Vec3A, b: Vec3A| (a - b).abs().max_element() < 1e-6;
        assert!(near(left.min, Vec3A::ZERO) && near(left.max, Vec3A::new(1.0, 2.0, 0.0)));
        assert!(near(right.min, Vec3A::new(1.0, 2.0, 0.0)) && near(right.max, Vec3A::new(4.0, 8.0, 0.0)));
        assert_eq!((left.max.x, right.min.x), (1.0, 1.0));
    }

    #[test]
    fn a_flat_triangle_stays_flat() {
        let corners = [Vec3A::new(0.1, 0.3, 0.7), Vec3A::new(5.3, 0.3, 0.1), Vec3A::new(2.2, 0.3, 9.9)];
        for half in split_triangle(&corners, Aabb::of_triangle(corners), 2, 3.3) {
            assert_eq!((half.min.y, half.max.y), (0.3, 0.3));
        }
    }

    #[test]
    fn a_side_without_a_part_is_empty() {
        let corners = [Vec3A::ZERO, Vec3A::new(1.0, 0.0, 0.0), Vec3A::new(0.0, 1.0, 0.0)];
        let bounds = Aabb::new(Vec3A::ZERO, Vec3A::splat(3.0));
        let [left, right] = split_triangle(&corners, bounds, 0, 2.0);
        assert_eq!((left, right.is_empty()), (Aabb::of_triangle(corners), true));
    }

    #[test]
    fn a_triangle_is_seen_as_far_as_it_reaches_into_the_box() {
        let vertices = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let (mesh, _) = Mesh::new(vertices, vec![[0, 1, 2]]).unwrap();
        let space = |min: f32, max: f32| Aabb::new(Vec3A::splat(min), Vec3A::splat(max));
        assert_eq!(visible(&mesh, 0, space(-1.0, 9.0)), Some(mesh.bounds()));
        let part =
            visible(&mesh, 0, Aabb::new(Vec3A::new(3.0, 0.0, 0.0), Vec3A::new(4.0, 4.0, 0.0))).unwrap();
        assert!((part.max.y - 1.0).abs() < 1e-5 && part.min.x == 3.0, "{part:?}");
        // The box meets the triangle's box, but not the triangle.
        assert_eq!(visible(&mesh, 0, space(3.0, 4.0)), None);
    }
}
