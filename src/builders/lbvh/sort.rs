//! References in the order of their Morton codes: bounds, presplitting, codes and sort.

#![allow(unsafe_code)]

use super::key::{MortonKey, key_of};
use super::morton::MortonEncoder;
use crate::builders::api::builder::Stopwatch;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::presplit::{Presplit, PresplitConfig};
use crate::builders::prims::refs::{GRAIN, PrimInfo, PrimRefs};
use crate::geometry::Aabb;
use crate::memory::huge_pages;
use crate::parallel;
use crate::parallel::radix_sort::{self, BUCKET_BITS};
use std::mem::MaybeUninit;
use std::ops::Range;

/// What of the codes references are sorted by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SortBits {
    /// All 32 bits.
    All,
    /// The highest 12 bits, the other bits of codes being set to zero: the buckets of the paper. Within one,
    /// references are in the order of the mesh, pieces of triangles after whole ones.
    Highest,
}

impl SortBits {
    /// The bits that codes keep.
    pub const fn mask(self) -> u32 {
        match self {
            Self::All => u32::MAX,
            Self::Highest => u32::MAX << (u32::BITS - BUCKET_BITS),
        }
    }
}

/// Sorted keys; memory is reused from build to build.
#[derive(Default)]
pub(crate) struct MortonOrder {
    /// The keys, sorted by code.
    pub keys: Vec<MortonKey>,
    /// Bounds of the references.
    info: Option<PrimInfo>,
    presplit: Presplit,
}

impl MortonOrder {
    /// Computes the bounds of `prims`, and splits needles where there is a configuration, which is for whole meshes
    /// alone.
    pub fn take_up<G: Geometry>(
        &mut self,
        geometry: &G,
        prims: Range<u32>,
        presplit: Option<&PresplitConfig>,
        watch: &mut Stopwatch,
    ) {
        debug_assert!(presplit.is_none() || prims == geometry.prims());
        self.presplit.clear();
        let (Some(config), Some(mesh)) = (presplit, geometry.triangles()) else {
            self.info = Some(PrimInfo::of(geometry, prims));
            watch.lap("bounds");
            return;
        };
        let info = self.presplit.find(mesh, config);
        watch.lap("bounds");
        self.presplit.split(mesh, info.bounds, config);
        self.info = Some(self.presplit.chunks.iter().fold(info, |info, chunk| info.union(chunk.info)));
        watch.lap("presplit");
    }

    /// Sorts the references of `prims`, which were taken up before, by these bits of their codes. The memory of
    /// `spare` is used meanwhile; its elements are lost.
    pub fn sort<G: Geometry, T>(
        &mut self,
        geometry: &G,
        prims: Range<u32>,
        bits: SortBits,
        spare: &mut Vec<T>,
        watch: &mut Stopwatch,
    ) {
        let info = self.info.expect("references are taken up before they are sorted");
        let len = prims.len() + self.extra_references();
        let mut keys = std::mem::take(&mut self.keys);
        keys.clear();
        huge_pages::reserve(&mut keys, len, "keys");
        let places = &mut keys.spare_capacity_mut()[..len];
        self.encode(geometry, prims, &MortonEncoder::new(info.centers), bits.mask(), places);
        // SAFETY: `encode` has written every key.
        unsafe { keys.set_len(len) };
        watch.lap("codes");
        let unsorted = huge_pages::lend(spare, len, "unsorted keys");
        match bits {
            SortBits::All => radix_sort::sort(&mut keys, unsorted),
            SortBits::Highest => radix_sort::bucket_sort(&mut keys, unsorted),
        }
        self.keys = keys;
        watch.lap("sort");
    }

    /// References beyond one of each primitive that was taken up.
    pub fn extra_references(&self) -> usize {
        self.presplit.chunks.iter().map(|chunk| chunk.pieces - chunk.needles).sum()
    }

    /// Sorts all primitives of a geometry by all bits of their codes, likewise.
    pub fn sort_all<G: Geometry, T>(&mut self, geometry: &G, spare: &mut Vec<T>, watch: &mut Stopwatch) {
        self.take_up(geometry, geometry.prims(), None, watch);
        self.sort(geometry, geometry.prims(), SortBits::All, spare, watch);
    }

    /// Writes every key: those of the triangles in order, then those of the pieces but for the first of each needle,
    /// which takes the place of its triangle.
    fn encode<G: Geometry>(
        &self,
        geometry: &G,
        prims: Range<u32>,
        encoder: &MortonEncoder,
        mask: u32,
        keys: &mut [MaybeUninit<MortonKey>],
    ) {
        let (of_triangles, mut of_pieces) = keys.split_at_mut(prims.len());
        let mut tasks = Vec::with_capacity(of_triangles.len().div_ceil(GRAIN));
        let mut piece = 0;
        for (i, of_triangles) in of_triangles.chunks_mut(GRAIN).enumerate() {
            let chunk = self.presplit.chunks.get(i);
            let (pieces, needles) = chunk.map_or((0, 0), |chunk| (chunk.pieces, chunk.needles));
            let (own, others) = of_pieces.split_at_mut(pieces - needles);
            tasks.push((prims.start as usize + i * GRAIN, of_triangles, own, piece..piece + pieces));
            (of_pieces, piece) = (others, piece + pieces);
        }
        assert!(of_pieces.is_empty());
        parallel::for_each(tasks, |(first, of_triangles, of_pieces, pieces)| {
            let prims = first as u32..(first + of_triangles.len()) as u32;
            let mut triangles = prims.clone().zip(&mut *of_triangles);
            encoder.codes(prims.map(|prim| geometry.bounds_of(prim).center2()), |code| {
                if let Some((prim, key)) = triangles.next() {
                    key.write(key_of(code & mask, prim));
                }
            });
            let (mut others, mut last) = (of_pieces.iter_mut(), None);
            for (i, fragment) in pieces.clone().zip(&self.presplit.fragments[pieces]) {
                let key = if last.replace(fragment.prim) == Some(fragment.prim) {
                    others.next().expect("there are places for all but the first of each")
                } else {
                    &mut of_triangles[fragment.prim as usize - first]
                };
                let code = encoder.code(fragment.bounds.center2()) & mask;
                key.write(key_of(code, (geometry.len() + i) as u32));
            }
            assert!(others.next().is_none());
        });
    }

    /// What the keys refer to.
    pub fn refs<'a, G>(&'a self, geometry: &'a G) -> PrimRefs<'a, G> {
        PrimRefs { geometry, fragments: &self.presplit.fragments }
    }

    /// Box of the scene.
    pub fn bounds(&self) -> Aabb {
        self.info.map_or(Aabb::EMPTY, |info| info.bounds)
    }
}
