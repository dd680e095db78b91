//! What a tree is built over: references to triangles, each with a box. A triangle is referred to once by its
//! whole box, or several times by the boxes of its parts where it was split before.

use crate::geometry::{Aabb, Mesh};
use crate::parallel;
use rayon::prelude::*;
use std::ops::Range;

/// References per task of a parallel pass over all of them.
pub(crate) const GRAIN: usize = 1 << 13;

/// A part of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fragment {
    /// Its box.
    pub bounds: Aabb,
    /// The triangle.
    pub prim: u32,
}

/// The references of a build. Boxes are computed from the mesh each time: that costs hardly more than reading them back,
/// and no memory.
#[derive(Clone, Copy)]
pub(crate) struct PrimRefs<'a> {
    /// The triangles; reference i < `mesh.len()` is triangle i.
    pub mesh: &'a Mesh,
    /// The references from `mesh.len()` on.
    pub fragments: &'a [Fragment],
}

impl PrimRefs<'_> {
    /// The box of a reference.
    #[inline]
    pub fn bounds(&self, reference: u32) -> Aabb {
        match self.fragment(reference) {
            None => self.mesh.bounds_of(reference),
            Some(fragment) => fragment.bounds,
        }
    }

    /// The triangle of a reference.
    #[inline]
    pub fn prim(&self, reference: u32) -> u32 {
        self.fragment(reference).map_or(reference, |fragment| fragment.prim)
    }

    #[inline]
    fn fragment(&self, reference: u32) -> Option<&Fragment> {
        // One comparison for nearly all references.
        (reference as usize).checked_sub(self.mesh.len()).map(|i| &self.fragments[i])
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

    /// Of some triangles of `mesh`.
    pub fn of(mesh: &Mesh, prims: Range<u32>) -> Self {
        let triangles = &mesh.triangles()[prims.start as usize..prims.end as usize];
        let parts = parallel::map(triangles.par_chunks(GRAIN), |triangles| {
            let (mut bounds, mut centers) = (Aabb::EMPTY, Aabb::EMPTY);
            for triangle in triangles {
                let b = Aabb::of_triangle(mesh.corners_of(triangle));
                bounds = bounds.union(b);
                centers = centers.grow(b.center2());
            }
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
