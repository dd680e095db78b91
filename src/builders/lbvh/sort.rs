//! References in the order of their Morton codes, and how a run of them parts in two (paper 4.7).

#![allow(unsafe_code)]

use crate::builders::builder::Stopwatch;
use crate::builders::lbvh::morton::Quantizer;
use crate::builders::prims::presplit::{Presplit, PresplitConfig};
use crate::builders::prims::refs::{Extent, GRAIN, References};
use crate::geometry::{Aabb, Mesh};
use crate::memory::huge_pages;
use crate::parallel::radix_sort;
use glam::Vec3A;
use rayon::prelude::*;

/// Splits of a run by further bits than codes have, before it is halved by count: with the bits of a code they
/// bound the depth of any tree by 44 and another 28 levels.
pub(crate) const MIDDLE_DEPTH: u32 = 12;

/// Sorted codes; memory is reused from build to build.
#[derive(Default)]
pub(crate) struct MortonOrder {
    /// [`Key`]s, sorted.
    pub keys: Vec<Key>,
    /// What bounds the triangles.
    extent: Option<Extent>,
    presplit: Presplit,
}

/// (code << 32 | reference).
pub(crate) type Key = u64;

/// The key of a reference.
#[inline]
fn key_of(code: u32, reference: u32) -> Key {
    u64::from(code) << 32 | u64::from(reference)
}

/// The reference of a key.
#[inline]
pub(crate) fn reference(key: Key) -> u32 {
    key as u32
}

/// The code of a key.
#[inline]
pub(crate) fn code(key: Key) -> u32 {
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
        self.presplit.clear();
        if let Some(config) = presplit {
            self.presplit.split(mesh, extent.bounds, config);
            extent = self.presplit.chunks.iter().fold(extent, |extent, chunk| extent.union(chunk.extent));
            watch.lap("presplit");
        }
        self.extent = Some(extent);
        let quantizer = Quantizer::new(extent.centers);
        let chunks = &self.presplit.chunks;
        let more: usize = chunks.iter().map(|chunk| chunk.pieces - chunk.needles).sum();
        let keys = huge_pages::lend(spare, mesh.len() + more);
        let (of_triangles, mut of_pieces) = keys.split_at_mut(mesh.len());
        let mut parts = Vec::with_capacity(of_triangles.len().div_ceil(GRAIN));
        let mut piece = 0;
        for (i, of_triangles) in of_triangles.chunks_mut(GRAIN).enumerate() {
            let (pieces, needles) = chunks.get(i).map_or((0, 0), |chunk| (chunk.pieces, chunk.needles));
            let (own, others) = of_pieces.split_at_mut(pieces - needles);
            parts.push((i * GRAIN, of_triangles, own, piece..piece + pieces));
            (of_pieces, piece) = (others, piece + pieces);
        }
        assert!(of_pieces.is_empty());
        parts.into_par_iter().for_each(|(first, of_triangles, of_pieces, pieces)| {
            let prims = first as u32..(first + of_triangles.len()) as u32;
            let mut triangles = prims.clone().zip(&mut *of_triangles);
            quantizer.codes(prims.map(|prim| mesh.bounds_of(prim).center2()), |code| {
                if let Some((prim, key)) = triangles.next() {
                    key.write(key_of(code, prim));
                }
            });
            let (mut others, mut last) = (of_pieces.iter_mut(), None);
            for (i, fragment) in pieces.clone().zip(&self.presplit.fragments[pieces]) {
                // The first piece of a triangle takes its place.
                let place = if last.replace(fragment.prim) == Some(fragment.prim) {
                    others.next().expect("there are places for all but the first of each")
                } else {
                    &mut of_triangles[fragment.prim as usize - first]
                };
                place.write(key_of(quantizer.code(fragment.bounds.center2()), (mesh.len() + i) as u32));
            }
            assert!(others.next().is_none());
        });
        // SAFETY: a key was written for each triangle of each part, and, as seen, in all places after those.
        let keys = unsafe { &mut *(std::ptr::from_mut(keys) as *mut [Key]) };
        watch.lap("codes");
        huge_pages::resize(&mut self.keys, keys.len(), 0);
        radix_sort::sort(keys, &mut self.keys);
        watch.lap("sort");
    }

    /// What the keys refer to.
    pub fn references<'a>(&'a self, mesh: &'a Mesh) -> References<'a> {
        References { mesh, fragments: &self.presplit.fragments }
    }

    /// Box of the scene.
    pub fn bounds(&self) -> Aabb {
        self.extent.map_or(Aabb::EMPTY, |extent| extent.bounds)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.keys.capacity() * size_of::<Key>() + self.presplit.bytes()
    }
}

/// Where a run of two or more sorted keys parts in two: where the highest bit changes in which their codes
/// differ. A run of one code is reordered to part at the middle of its own centroids' bounds, which is what
/// further bits would say; `depth` counts such splits.
pub(crate) fn part(keys: &mut [Key], references: &References<'_>, depth: &mut u32) -> usize {
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
pub(crate) fn part_by_middle<T: Copy>(items: &mut [T], center2: impl Fn(&T) -> Vec3A) -> usize {
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
