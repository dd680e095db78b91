//! References in the order of their Morton codes, and how a run of them parts in two (paper 4.7).

#![allow(unsafe_code)]

use super::morton::Quantizer;
use super::presplit::{self, PresplitConfig};
use super::references::{Extent, Fragment, GRAIN, References};
use super::{Stopwatch, pages, radix_sort};
use crate::geometry::{Aabb, Mesh};
use glam::Vec3A;
use rayon::prelude::*;

/// Splits of a run by further bits than codes have, before it is halved by count: with the bits of a code they
/// bound the depth of any tree by 44 and another 28 levels.
pub(super) const MIDDLE_DEPTH: u32 = 12;

/// Sorted codes; memory is reused from build to build.
#[derive(Default)]
pub(super) struct MortonOrder {
    /// [`Key`]s, sorted.
    pub keys: Vec<Key>,
    /// What bounds the triangles.
    extent: Option<Extent>,
    fragments: Vec<Fragment>,
}

/// (code << 32 | reference).
pub(super) type Key = u64;

/// The key of a reference with the given box.
#[inline]
fn key_of(quantizer: &Quantizer, bounds: Aabb, reference: usize) -> Key {
    u64::from(quantizer.code(bounds.center2())) << 32 | reference as u64
}

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
    /// Sorts the triangles of a mesh, those of them in pieces that `presplit` says. The memory of `spare`, whose
    /// elements are lost, is used meanwhile.
    pub fn sort<T>(
        &mut self,
        mesh: &Mesh,
        presplit: Option<&PresplitConfig>,
        spare: &mut Vec<T>,
        watch: &mut Stopwatch,
    ) {
        let mut extent = Extent::of(mesh);
        watch.lap("bounds");
        self.fragments.clear();
        if let Some(config) = presplit {
            self.fragments = presplit::presplit(mesh, extent.bounds, config);
            extent = self.fragments.iter().fold(extent, |extent, fragment| extent.grow(fragment.bounds));
            watch.lap("presplit");
        }
        self.extent = Some(extent);
        let quantizer = Quantizer::new(extent.centers);
        let pieces = self.fragments.chunk_by(|a, b| a.prim == b.prim);
        let (n, more) = (mesh.len(), self.fragments.len() - pieces.count());
        let keys = pages::lend(spare, n + more);
        let (of_triangles, of_pieces) = keys.split_at_mut(n);
        of_triangles.par_chunks_mut(GRAIN).enumerate().for_each(|(chunk, keys)| {
            let first = (chunk * GRAIN) as u32;
            let prims = first..first + keys.len() as u32;
            let mut keys = prims.clone().zip(keys);
            quantizer.codes(prims.map(|prim| mesh.bounds_of(prim).center2()), |code| {
                if let Some((prim, key)) = keys.next() {
                    key.write(u64::from(code) << 32 | u64::from(prim));
                }
            });
        });
        let (mut of_pieces, mut last) = (of_pieces.iter_mut(), None);
        for (i, fragment) in self.fragments.iter().enumerate() {
            let key = key_of(&quantizer, fragment.bounds, n + i);
            // The first piece of a triangle takes its place.
            let place = if last.replace(fragment.prim) == Some(fragment.prim) {
                of_pieces.next().expect("there are places for all but the first of each")
            } else {
                &mut of_triangles[fragment.prim as usize]
            };
            place.write(key);
        }
        assert!(of_pieces.next().is_none());
        // SAFETY: a key was written for each triangle, and, as just seen, in all places after those.
        let keys = unsafe { &mut *(std::ptr::from_mut(keys) as *mut [Key]) };
        watch.lap("codes");
        pages::resize(&mut self.keys, keys.len(), 0);
        radix_sort::sort(keys, &mut self.keys);
        watch.lap("sort");
    }

    /// What the keys refer to.
    pub fn references<'a>(&'a self, mesh: &'a Mesh) -> References<'a> {
        References { mesh, fragments: &self.fragments }
    }

    /// Box of the scene.
    pub fn bounds(&self) -> Aabb {
        self.extent.map_or(Aabb::EMPTY, |extent| extent.bounds)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.keys.capacity() * size_of::<Key>() + self.fragments.capacity() * size_of::<Fragment>()
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
    part_by_middle(keys, |&key| references.bounds(reference(key)).center2())
}

/// Moves to the front the items whose centroid lies before the middle of the longest edge of the centroids'
/// bounds. Returns their number; half of all where they do not lie apart.
pub(super) fn part_by_middle<T: Copy>(items: &mut [T], center2: impl Fn(&T) -> Vec3A) -> usize {
    let all = items.iter().fold(Aabb::EMPTY, |all, item| all.grow(center2(item)));
    let axis = all.extent().max_position();
    let middle = Vec3A::splat(all.center()[axis]);
    let mut split = 0;
    for i in 0..items.len() {
        let is_before = center2(&items[i]).cmplt(middle).bitmask() >> axis & 1 == 1;
        // No branch: it could not be foreseen.
        items.swap(i, if is_before { split } else { i });
        split += usize::from(is_before);
    }
    if (1..items.len()).contains(&split) { split } else { items.len() / 2 }
}
