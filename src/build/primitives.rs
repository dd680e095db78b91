//! Primitive boxes: what every builder starts from.

use crate::geometry::{Aabb, Mesh};
use rayon::prelude::*;

/// Triangles per task of a parallel pass over all of them.
pub(super) const GRAIN: usize = 1 << 13;

/// The boxes of all triangles and what bounds them.
#[derive(Default)]
pub(super) struct Primitives {
    /// One box per triangle, by triangle id.
    pub boxes: Vec<Aabb>,
    /// Box of the scene.
    pub bounds: Aabb,
    /// Box of the doubled centroids ([`Aabb::center2`]).
    pub centers: Aabb,
}

impl Primitives {
    /// Computes the boxes of `mesh` anew, into the memory of the last call.
    pub fn collect(&mut self, mesh: &Mesh) {
        let triangles = mesh.triangles();
        super::pages::resize(&mut self.boxes, triangles.len(), Aabb::EMPTY);
        (self.bounds, self.centers) = self
            .boxes
            .par_chunks_mut(GRAIN)
            .enumerate()
            .map(|(chunk, boxes)| {
                let first = chunk * GRAIN;
                let (mut bounds, mut centers) = (Aabb::EMPTY, Aabb::EMPTY);
                for (i, slot) in boxes.iter_mut().enumerate() {
                    let b = mesh.bounds_of((first + i) as u32);
                    bounds = bounds.union(b);
                    centers = centers.grow(b.center2());
                    *slot = b;
                }
                (bounds, centers)
            })
            .reduce(|| (Aabb::EMPTY, Aabb::EMPTY), |a, b| (a.0.union(b.0), a.1.union(b.1)));
    }
}
