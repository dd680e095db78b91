//! References of one code, parted by the middle of their centroids' bounds: what further bits would say.

use super::heights::Heights;
use super::morton_order::{Key, MIDDLE_DEPTH, part_by_middle};
use crate::geometry::Aabb;
use glam::{Vec3A, Vec4};
use std::ops::Range;

/// Memory to part references in.
#[derive(Default)]
pub(super) struct SameCode {
    /// Doubled centroids, their numbers the fourth float: all that moves while they are parted.
    centers: Vec<Vec4>,
    keys: Vec<Key>,
    bounds: Vec<Aabb>,
}

impl SameCode {
    /// Reorders the references of `range`, all of one code, and tells at which heights they part.
    pub fn part(
        &mut self,
        range: Range<usize>,
        [depth, leaf]: [u32; 2],
        keys: &mut [Key],
        bounds: &mut [Aabb],
        heights: &mut Heights,
    ) {
        let (keys, bounds) = (&mut keys[range.clone()], &mut bounds[range.clone()]);
        let center = |(i, bounds): (u16, &Aabb)| bounds.center2().extend(f32::from(i));
        self.centers.clear();
        self.centers.extend((0..).zip(&*bounds).map(center));
        part(&mut self.centers, range.start, depth, leaf, heights);
        self.keys.clear();
        self.keys.extend_from_slice(keys);
        self.bounds.clear();
        self.bounds.extend_from_slice(bounds);
        for ((center, key), bounds) in self.centers.iter().zip(keys).zip(bounds) {
            let from = center.w as usize;
            (*key, *bounds) = (self.keys[from], self.bounds[from]);
        }
    }
}

/// Parts centroids, the first of which is that of reference `first`, down to leaves.
fn part(centers: &mut [Vec4], first: usize, depth: u32, leaf: u32, heights: &mut Heights) {
    if centers.len() <= leaf as usize {
        return;
    }
    let split = if centers.len() == 2 || depth >= MIDDLE_DEPTH {
        centers.len() / 2
    } else {
        part_by_middle(centers, |center| Vec3A::from_vec4(*center))
    };
    heights.part_by_middle(first + split, depth);
    let (left, right) = centers.split_at_mut(split);
    part(left, first, depth + 1, leaf, heights);
    part(right, first + split, depth + 1, leaf, heights);
}
