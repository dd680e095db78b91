//! Axis-aligned bounding boxes.

use glam::{BVec3A, Vec3A};

/// An axis-aligned box in scene units, both corners inclusive. Empty boxes have `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Aabb {
    /// Lower corner.
    pub min: Vec3A,
    /// Upper corner.
    pub max: Vec3A,
}

impl Aabb {
    /// The box that contains nothing; the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    /// The box of the two corners as given.
    #[inline]
    pub const fn new(min: Vec3A, max: Vec3A) -> Self {
        Self { min, max }
    }

    /// The smallest box around three points.
    #[inline(always)]
    pub fn of_triangle(v: [Vec3A; 3]) -> Self {
        Self { min: v[0].min(v[1]).min(v[2]), max: v[0].max(v[1]).max(v[2]) }
    }

    /// The smallest box that contains both.
    #[inline(always)]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box grown to contain `point`.
    #[inline(always)]
    #[must_use]
    pub fn grow(self, point: Vec3A) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The common part, empty ([`Aabb::is_empty`]) if there is none.
    #[inline]
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// True if some lower coordinate exceeds its upper one (or is NaN). A flat box is not empty.
    #[inline]
    pub fn is_empty(self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// True if every point of `other` lies in this box.
    #[inline]
    pub fn contains(self, other: Self) -> bool {
        self.min.cmple(other.min).all() && self.max.cmpge(other.max).all()
    }

    /// The part below `plane` along an axis.
    #[inline(always)]
    #[must_use]
    pub(crate) fn below(mut self, axis: usize, plane: f32) -> Self {
        // Vectors are never written in parts: a later read would wait for them.
        self.max = self.max.min(Vec3A::select(along(axis), Vec3A::splat(plane), Vec3A::INFINITY));
        self
    }

    /// The part above `plane` along an axis.
    #[inline(always)]
    #[must_use]
    pub(crate) fn above(mut self, axis: usize, plane: f32) -> Self {
        self.min = self.min.max(Vec3A::select(along(axis), Vec3A::splat(plane), Vec3A::NEG_INFINITY));
        self
    }

    /// Twice the centre: comparisons of centroids need no division.
    #[inline(always)]
    pub fn center2(self) -> Vec3A {
        self.min + self.max
    }

    /// The centre.
    #[inline]
    pub fn center(self) -> Vec3A {
        self.center2() * 0.5
    }

    /// Edge lengths, negative where empty.
    #[inline]
    pub fn extent(self) -> Vec3A {
        self.max - self.min
    }

    /// Half the surface area, `x (y + z) + y z` as Embree computes it; 0 for an empty box.
    #[inline]
    pub fn half_area(self) -> f32 {
        let e = self.extent().max(Vec3A::ZERO);
        e.x * (e.y + e.z) + e.y * e.z
    }
}

/// True for one axis.
#[inline(always)]
fn along(axis: usize) -> BVec3A {
    BVec3A::new(axis == 0, axis == 1, axis == 2)
}

impl Default for Aabb {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl FromIterator<Self> for Aabb {
    fn from_iter<I: IntoIterator<Item = Self>>(boxes: I) -> Self {
        boxes.into_iter().fold(Self::EMPTY, Self::union)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_of_simple_boxes() {
        let cube = Aabb::new(Vec3A::ZERO, Vec3A::ONE);
        assert_eq!(cube.half_area(), 3.0);
        assert_eq!(Aabb::EMPTY.half_area(), 0.0);
        assert!(Aabb::EMPTY.is_empty());
        let flat = Aabb::new(Vec3A::ZERO, Vec3A::new(2.0, 3.0, 0.0));
        assert!(!flat.is_empty());
        assert_eq!(flat.half_area(), 6.0);
    }

    #[test]
    fn union_and_intersection_are_bounds() {
        let a = Aabb::new(Vec3A::ZERO, Vec3A::ONE);
        let b = Aabb::new(Vec3A::splat(0.5), Vec3A::splat(2.0));
        assert!(a.union(b).contains(a) && a.union(b).contains(b));
        assert!(a.contains(a.intersection(b)) && b.contains(a.intersection(b)));
        assert!(a.intersection(Aabb::new(Vec3A::splat(3.0), Vec3A::splat(4.0))).is_empty());
        assert_eq!(a.union(Aabb::EMPTY), a);
    }
}
