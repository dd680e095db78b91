//! Triangles in the order of their Morton codes, and how a run of them parts in two (paper 4.7).

use super::morton::Quantizer;
use super::primitives::{GRAIN, Primitives};
use super::{Stopwatch, pages, radix_sort};
use crate::geometry::{Aabb, Mesh};
use rayon::prelude::*;

/// Beyond this depth runs are halved by count, so that no input makes a tree deeper than this plus 28 levels.
const MAX_CODED_DEPTH: u32 = 44;

/// Boxes and sorted codes of a mesh; memory is reused from build to build.
#[derive(Default)]
pub(super) struct MortonOrder {
    /// Boxes of the triangles, by triangle id.
    pub primitives: Primitives,
    /// [`Key`]s, sorted.
    pub keys: Vec<Key>,
    scratch: Vec<Key>,
}

/// (code << 32 | triangle).
pub(super) type Key = u64;

/// The triangle of a key.
#[inline]
pub(super) fn prim(key: Key) -> u32 {
    key as u32
}

#[inline]
fn code(key: Key) -> u32 {
    (key >> 32) as u32
}

impl MortonOrder {
    /// Computes the boxes and sorts the triangles of `mesh`.
    pub fn sort(&mut self, mesh: &Mesh, watch: &mut Stopwatch) {
        self.primitives.collect(mesh);
        watch.lap("boxes");
        let quantizer = Quantizer::new(self.primitives.centers);
        let boxes = &self.primitives.boxes;
        pages::resize(&mut self.keys, boxes.len(), 0);
        pages::resize(&mut self.scratch, boxes.len(), 0);
        self.keys.par_chunks_mut(GRAIN).enumerate().for_each(|(chunk, keys)| {
            for (prim, key) in (chunk * GRAIN..).zip(keys) {
                *key = u64::from(quantizer.code(boxes[prim].center2())) << 32 | prim as u64;
            }
        });
        watch.lap("codes");
        radix_sort::sort(&mut self.keys, &mut self.scratch);
        watch.lap("sort");
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.primitives.boxes.capacity() * size_of::<Aabb>()
            + (self.keys.capacity() + self.scratch.capacity()) * size_of::<Key>()
    }
}

/// Where a run of two or more sorted keys, `depth` splits below the whole, parts in two: where the highest bit
/// changes in which their codes differ. A run of one code is reordered to part at the middle of its own
/// centroids' bounds, which is what further bits would say.
pub(super) fn part(keys: &mut [Key], boxes: &[Aabb], depth: u32) -> usize {
    let (first, last) = (code(keys[0]), code(keys[keys.len() - 1]));
    if keys.len() == 2 || depth >= MAX_CODED_DEPTH {
        keys.len() / 2
    } else if first == last {
        part_by_middle(keys, boxes)
    } else {
        let bit = 1 << (31 - (first ^ last).leading_zeros());
        keys.partition_point(|&key| code(key) & bit == 0)
    }
}

/// Moves to the front the keys whose centroid lies before the middle of the longest edge of the centroids'
/// bounds. Returns their number; half of all where they do not lie apart.
fn part_by_middle(keys: &mut [Key], boxes: &[Aabb]) -> usize {
    let center = |key: Key| boxes[prim(key) as usize].center2();
    let bounds = keys.iter().fold(Aabb::EMPTY, |bounds, &key| bounds.grow(center(key)));
    let axis = bounds.extent().max_position();
    let middle = bounds.center()[axis];
    let mut split = 0;
    for i in 0..keys.len() {
        if center(keys[i])[axis] < middle {
            keys.swap(i, split);
            split += 1;
        }
    }
    if (1..keys.len()).contains(&split) { split } else { keys.len() / 2 }
}
