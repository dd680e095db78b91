//! References in the order of their Morton codes, and how a run of them parts in two (paper 4.7).

use super::morton::Quantizer;
use super::references::{Extent, GRAIN, References};
use super::{Stopwatch, pages, radix_sort};
use crate::geometry::Aabb;
use rayon::prelude::*;

/// Splits of a run by further bits than codes have, before it is halved by count: with the bits of a code they
/// bound the depth of any tree by 44 and another 28 levels.
const MIDDLE_DEPTH: u32 = 12;

/// Sorted codes; memory is reused from build to build.
#[derive(Default)]
pub(super) struct MortonOrder {
    /// [`Key`]s, sorted.
    pub keys: Vec<Key>,
    /// What bounds the triangles.
    pub extent: Option<Extent>,
    scratch: Vec<Key>,
}

/// (code << 32 | reference).
pub(super) type Key = u64;

/// The reference of a key.
#[inline]
pub(super) fn reference(key: Key) -> u32 {
    key as u32
}

/// The code of a key.
#[inline]
pub(super) fn code(key: Key) -> u32 {
    (key >> 32) as u32
}

impl MortonOrder {
    /// Sorts the triangles of a mesh.
    pub fn sort(&mut self, references: &References<'_>, watch: &mut Stopwatch) {
        let extent = Extent::of(references.mesh);
        self.extent = Some(extent);
        watch.lap("bounds");
        let quantizer = Quantizer::new(extent.centers);
        let n = references.mesh.len();
        pages::resize(&mut self.keys, n, 0);
        pages::resize(&mut self.scratch, n, 0);
        self.keys.par_chunks_mut(GRAIN).enumerate().for_each(|(chunk, keys)| {
            for (prim, key) in (chunk * GRAIN..).zip(keys) {
                let center = references.bounds(prim as u32).center2();
                *key = u64::from(quantizer.code(center)) << 32 | prim as u64;
            }
        });
        watch.lap("codes");
        radix_sort::sort(&mut self.keys, &mut self.scratch);
        watch.lap("sort");
    }

    /// Box of the scene.
    pub fn bounds(&self) -> Aabb {
        self.extent.map_or(Aabb::EMPTY, |extent| extent.bounds)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        (self.keys.capacity() + self.scratch.capacity()) * size_of::<Key>()
    }
}

/// Where a run of two or more sorted keys parts in two: where the highest bit changes in which their codes
/// differ. A run of one code is reordered to part at the middle of its own centroids' bounds, which is what
/// further bits would say; `depth` counts such splits.
pub(super) fn part(keys: &mut [Key], references: &References<'_>, depth: &mut u32) -> usize {
    let (first, last) = (code(keys[0]), code(keys[keys.len() - 1]));
    if first != last {
        let bit = 1 << (31 - (first ^ last).leading_zeros());
        return keys.partition_point(|&key| code(key) & bit == 0);
    }
    *depth += 1;
    if keys.len() == 2 || *depth > MIDDLE_DEPTH {
        return keys.len() / 2;
    }
    part_by_middle(keys, |key| references.bounds(reference(*key)))
}

/// As [`part`], of references of one code that stand beside their boxes.
pub(super) fn part_boxed(run: &mut [(Key, Aabb)], depth: u32) -> usize {
    if run.len() == 2 || depth > MIDDLE_DEPTH { run.len() / 2 } else { part_by_middle(run, |(_, b)| *b) }
}

/// Moves to the front the items whose centroid lies before the middle of the longest edge of the centroids'
/// bounds. Returns their number; half of all where they do not lie apart.
fn part_by_middle<T>(items: &mut [T], bounds: impl Fn(&T) -> Aabb) -> usize {
    let all = items.iter().fold(Aabb::EMPTY, |all, item| all.grow(bounds(item).center2()));
    let axis = all.extent().max_position();
    let middle = all.center()[axis];
    let mut split = 0;
    for i in 0..items.len() {
        if bounds(&items[i]).center2()[axis] < middle {
            items.swap(i, split);
            split += 1;
        }
    }
    if (1..items.len()).contains(&split) { split } else { items.len() / 2 }
}
