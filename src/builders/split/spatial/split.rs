//! A spatial split: a plane, and which boxes are on which side of it.

use crate::geometry::Aabb;

/// The best spatial split of a cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SpatialSplit {
    /// `C_S` of equation 3 with half areas; infinite if there is no plane.
    pub cost: f32,
    /// Axis the plane is normal to.
    pub axis: usize,
    /// Where it is.
    pub plane: f32,
}

impl SpatialSplit {
    /// No split.
    pub const NONE: Self = Self { cost: f32::INFINITY, axis: 0, plane: 0.0 };

    /// Whether a box is on the left of the plane. A box that lies in it is: it must be on one side.
    #[inline]
    pub fn on_left(&self, bounds: Aabb) -> bool {
        let (min, max) = (bounds.min[self.axis], bounds.max[self.axis]);
        min < self.plane || max <= self.plane
    }

    /// Whether a box is on the right of the plane.
    #[inline]
    pub fn on_right(&self, bounds: Aabb) -> bool {
        bounds.max[self.axis] > self.plane
    }

    /// The sides on which a box is that is not cut: that of its centroid.
    #[inline]
    pub fn sides_of_whole(&self, bounds: Aabb) -> [bool; 2] {
        match [self.on_left(bounds), self.on_right(bounds)] {
            [true, true] => {
                let is_right = bounds.center2()[self.axis] > 2.0 * self.plane;
                [!is_right, is_right]
            }
            sides => sides,
        }
    }

    /// The part of a box on the left.
    #[inline]
    pub fn left_of(&self, bounds: Aabb) -> Aabb {
        bounds.below(self.axis, self.plane)
    }

    /// The part of a box on the right.
    #[inline]
    pub fn right_of(&self, bounds: Aabb) -> Aabb {
        bounds.above(self.axis, self.plane)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3A;

    #[test]
    fn a_wall_in_the_plane_is_on_exactly_one_side() {
        let split = SpatialSplit { cost: 0.0, axis: 0, plane: 2.0 };
        for ([min, max], left, right) in [
            ([2., 2.], true, false),
            ([1., 2.], true, false),
            ([2., 3.], false, true),
            ([1., 3.], true, true),
        ] {
            let bounds = Aabb::new(Vec3A::new(min, 0., 0.), Vec3A::new(max, 1., 1.));
            assert_eq!((split.on_left(bounds), split.on_right(bounds)), (left, right));
        }
    }
}
