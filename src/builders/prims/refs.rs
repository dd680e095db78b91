//! What a tree is built over: references to primitives, each with a box. One is referred to once by its
//! whole box, or several times by the boxes of its parts where it was split before.

use super::geometry::Geometry;
use crate::geometry::{Aabb, Mesh};
use crate::parallel;
use std::ops::Range;

/// References per task of a parallel pass over all of them.
pub(crate) const GRAIN: usize = 1 << 12;

/// A part of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fragment {
    /// Its box.
    pub bounds: Aabb,
    /// The triangle.
    pub prim: u32,
}

/// The references of a build. Boxes of triangles are computed from the mesh each time: that costs hardly more than
/// reading them back, and no memory.
pub(crate) struct PrimRefs<'a, G = Mesh> {
    /// The primitives; reference i < `geometry.len()` is primitive i.
    pub geometry: &'a G,
    /// The references from `geometry.len()` on.
    pub fragments: &'a [Fragment],
}

impl<G> Clone for PrimRefs<'_, G> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<G> Copy for PrimRefs<'_, G> {}

impl<G: Geometry> PrimRefs<'_, G> {
    /// The box of a reference.
    #[inline]
    pub fn bounds(&self, reference: u32) -> Aabb {
        match self.fragment(reference) {
            None => self.geometry.bounds_of(reference),
            Some(fragment) => fragment.bounds,
        }
    }

    /// The primitive of a reference.
    #[inline]
    pub fn prim(&self, reference: u32) -> u32 {
        self.fragment(reference).map_or(reference, |fragment| fragment.prim)
    }

    /// The piece of a triangle that it refers to, if it is no whole primitive.
    #[inline]
    pub fn fragment(&self, reference: u32) -> Option<&Fragment> {
        // One comparison for nearly all references.
        (reference as usize).checked_sub(self.geometry.len()).map(|i| &self.fragments[i])
    }
}

/// Bounds of references (Embree's PrimInfo).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PrimInfo {
    /// Their box.
    pub bounds: Aabb,
    /// The box of their doubled centroids ([`Aabb::center2`]).
    pub centers: Aabb,
}

impl PrimInfo {
    /// Of nothing.
    pub const EMPTY: Self = Self { bounds: Aabb::EMPTY, centers: Aabb::EMPTY };

    /// Of some primitives of `geometry`.
    pub fn of(geometry: &impl Geometry, prims: Range<u32>) -> Self {
        let (first, end) = (prims.start as usize, prims.end as usize);
        let parts = parallel::map(0..(end - first).div_ceil(GRAIN), |task| {
            let begin = first + task * GRAIN;
            let (mut bounds, mut centers) = (Aabb::EMPTY, Aabb::EMPTY);
            geometry.for_each(begin..end.min(begin + GRAIN), |b| {
                bounds = bounds.union(b);
                centers = centers.grow(b.center2());
            });
            Self { bounds, centers }
        });
        parts.into_iter().fold(Self::EMPTY, Self::union)
    }

    /// Bounds of both.
    pub fn union(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), centers: self.centers.union(other.centers) }
    }

    /// Bounds with another reference.
    pub fn grow(self, bounds: Aabb) -> Self {
        Self { bounds: self.bounds.union(bounds), centers: self.centers.grow(bounds.center2()) }
    }
}
