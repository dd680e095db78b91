//! The bins of a node along three axes, and the cheapest plane between them.

use super::config::MOST_BINS;
use crate::builders::prims::refs::PrimInfo;
use crate::builders::split::cost::{CountedBox, Weight};
use crate::geometry::Aabb;
use arrayvec::ArrayVec;

/// Which bin a centroid is in.
#[derive(Clone, Copy)]
pub(super) struct Binning {
    origin: [f32; 3],
    scale: [f32; 3],
    last: usize,
}

impl Binning {
    /// Of centroids within `centers`.
    pub fn new(centers: Aabb, bins: usize) -> Self {
        // Centroids on the upper face are in the last bin; along an axis without extent all are in the first.
        let scale = centers.extent().to_array().map(|e| if e > 1e-30 { bins as f32 / e } else { 0.0 });
        Self { origin: centers.min.to_array(), scale, last: bins - 1 }
    }

    /// The bin along an axis of a box.
    #[inline]
    pub fn bin(&self, bounds: Aabb, axis: usize) -> usize {
        let at = (bounds.center2()[axis] - self.origin[axis]) * self.scale[axis];
        (at as usize).min(self.last)
    }
}

/// A plane: boxes in bins below it along an axis are on the left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub axis: usize,
    pub bin: usize,
}

/// Bins along three axes.
pub(super) struct SahBins {
    bins: Vec<CountedBox>,
    /// Bins of an axis.
    len: usize,
}

impl SahBins {
    /// Of the boxes.
    pub fn of(binning: &Binning, boxes: impl Iterator<Item = Aabb>) -> Self {
        let len = binning.last + 1;
        let mut bins = vec![CountedBox::EMPTY; 3 * len];
        for bounds in boxes {
            for (axis, bins) in bins.chunks_exact_mut(len).enumerate() {
                bins[binning.bin(bounds, axis)].add(bounds);
            }
        }
        Self { bins, len }
    }

    /// Those of both.
    pub fn union(mut self, other: &Self) -> Self {
        for (bin, other) in self.bins.iter_mut().zip(&other.bins) {
            *bin = bin.union(*other);
        }
        self
    }

    /// The plane of least cost, the first of equal ones; `None` where no plane has something on both sides.
    pub fn cheapest(&self) -> Option<Plane> {
        let mut best = (f32::INFINITY, None);
        for (axis, bins) in self.bins.chunks_exact(self.len).enumerate() {
            // What is right of each plane, the last first.
            let join = |right: &mut CountedBox, bin: &CountedBox| {
                *right = right.union(*bin);
                Some(*right)
            };
            let right: ArrayVec<CountedBox, MOST_BINS> =
                bins.iter().rev().scan(CountedBox::EMPTY, join).collect();
            let mut left = CountedBox::EMPTY;
            for bin in 1..self.len {
                left = left.union(bins[bin - 1]);
                let right = right[self.len - 1 - bin];
                let cost = left.cost(Weight::Nodes) + right.cost(Weight::Nodes);
                if left.count > 0 && right.count > 0 && cost < best.0 {
                    best = (cost, Some(Plane { axis, bin }));
                }
            }
        }
        best.1
    }
}

/// The box of references and of their centroids.
pub(super) fn info(boxes: impl Iterator<Item = Aabb>) -> PrimInfo {
    boxes.fold(PrimInfo::EMPTY, PrimInfo::grow)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3A;

    #[test]
    fn the_widest_gap_is_found_and_one_point_has_no_plane() {
        let at = |x: f32| Aabb::new(Vec3A::new(0.0, x, 0.0), Vec3A::new(1.0, x + 1.0, 1.0));
        let boxes: Vec<Aabb> = [0.0, 1.0, 2.0, 50.0, 51.0].map(at).to_vec();
        let binning = Binning::new(info(boxes.iter().copied()).centers, 16);
        let plane = SahBins::of(&binning, boxes.iter().copied()).cheapest().unwrap();
        let is_left = |b: &Aabb| binning.bin(*b, plane.axis) < plane.bin;
        assert_eq!(boxes.iter().map(is_left).collect::<Vec<_>>(), [true, true, true, false, false]);
        let halves = SahBins::of(&binning, boxes[..2].iter().copied());
        let both = halves.union(&SahBins::of(&binning, boxes[2..].iter().copied()));
        assert_eq!(both.cheapest(), Some(plane));
        let same = vec![at(3.0); 9];
        let binning = Binning::new(info(same.iter().copied()).centers, 16);
        assert_eq!(SahBins::of(&binning, same.into_iter()).cheapest(), None);
    }
}
