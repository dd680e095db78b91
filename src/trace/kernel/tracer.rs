//! Our kernel as a [`Tracer`]: picks the instruction set once per tracer.

#[cfg(target_arch = "x86_64")]
use super::avx2::{self, FastAvx2};
use super::counts::{Counter, TraversalCounts};
use super::scalar::FastScalar;
use super::sound_tree::{ProvenTree, SoundTree};
use super::traverse::{self, Query};
use crate::bvh::WideBvh;
use crate::geometry::{Hit, Ray, Tracer};
use crate::memory::catch_out_of_memory;
use crate::simd::Isa;
use rayon::prelude::*;
use std::ops::Add as _;

/// Traces rays through a tree with our kernel. The interval is `tnear < t <= tfar`; among equal distances
/// the triangle tested last wins. A ray that is not [`Ray::is_valid`] hits nothing.
///
/// The test multiplies two edges and the distance, and two edges and the direction, in `f32`, as Embree's does: where
/// such a product overflows or vanishes (scenes above some 5e12 or below 1e-12, whatever the direction, or any with
/// directions of 1e-38), closest hits are missed: none has a distance that is infinite, zero or NaN.
///
/// With AVX2 and AVX-512 the arithmetic is that of Embree's kernel for the same instructions, operation by operation,
/// so that hits on the same tree are the same bits.
#[derive(Clone, Copy, Debug)]
pub struct BvhTracer<'a, const N: usize> {
    tree: SoundTree<'a, N>,
    isa: Isa,
}

/// The instruction set that [`BvhTracer::new`] picks on this machine.
pub fn kernel_isa() -> Isa {
    Isa::best()
}

/// Proves that the kernel may follow the links of `tree` unchecked, or panics.
pub(super) fn sound<const N: usize>(tree: &WideBvh<N>) -> SoundTree<'_, N> {
    SoundTree::new(tree).unwrap_or_else(|flaw| panic!("malformed tree: {flaw}"))
}

impl<'a, const N: usize> BvhTracer<'a, N> {
    /// A tracer over `tree` with the best instructions of this machine. Walks the tree once, to prove that
    /// the kernel may follow its links unchecked.
    ///
    /// # Panics
    /// If `tree` is malformed (a builder's bug): links out of range, shared or cyclic nodes, more than
    /// [`crate::bvh::MAX_DEPTH`] inner levels. If there is no memory to find that out, which [`ProvenTree`] tells as an
    /// error.
    pub fn new(tree: &'a WideBvh<N>) -> Self {
        Self::with_isa(tree, Isa::best())
    }

    /// As [`BvhTracer::new`], over a tree that may be malformed.
    ///
    /// # Errors
    /// One line: a malformed tree, or no memory to walk it.
    pub fn try_new(tree: &'a WideBvh<N>) -> Result<Self, String> {
        let sound = catch_out_of_memory(|| SoundTree::new(tree)).map_err(|error| error.to_string())?;
        let tree = sound.map_err(|flaw| format!("malformed tree: {flaw}"))?;
        Ok(Self { tree, isa: Isa::best() })
    }

    /// As [`BvhTracer::new`] with instructions of choice. With AVX-512 only the estimate of reciprocals differs.
    ///
    /// # Panics
    /// As [`BvhTracer::new`].
    pub fn with_isa(tree: &'a WideBvh<N>, isa: Isa) -> Self {
        Self { tree: sound(tree), isa }
    }

    /// A tracer over a tree that is known to be sound.
    #[inline(always)]
    pub(super) fn of_sound(tree: SoundTree<'a, N>, isa: Isa) -> Self {
        Self { tree, isa }
    }

    /// The instructions in use.
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// Counts the visits of closest-hit queries of `rays`. Not for timing: it runs on the current rayon pool.
    pub fn count_closest(&self, rays: &[Ray]) -> TraversalCounts {
        self.count(rays, |chunk, counts| {
            let mut hits = vec![Hit::MISS; chunk.len()];
            self.run(Query::Closest(chunk, &mut hits), counts);
            hits.iter().filter(|hit| hit.is_hit()).count()
        })
    }

    /// Counts the visits of any-hit queries of `rays`, likewise.
    pub fn count_any(&self, rays: &[Ray]) -> TraversalCounts {
        self.count(rays, |chunk, counts| {
            let mut occluded = vec![false; chunk.len()];
            self.run(Query::Any(chunk, &mut occluded), counts);
            occluded.iter().filter(|&&hit| hit).count()
        })
    }

    fn count(
        &self,
        rays: &[Ray],
        trace: impl Fn(&[Ray], &mut TraversalCounts) -> usize + Sync,
    ) -> TraversalCounts {
        rays.par_chunks(4096)
            .map(|chunk| {
                let mut counts = TraversalCounts { rays: chunk.len() as u64, ..TraversalCounts::default() };
                counts.hits = trace(chunk, &mut counts) as u64;
                counts
            })
            .reduce(TraversalCounts::default, TraversalCounts::add)
    }

    /// Runs a batch; the instruction set is dispatched once per batch.
    fn run<C: Counter>(&self, query: Query<'_>, counter: &mut C) {
        match self.isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(token) => avx2::run::<FastAvx2<_>, C, N>(token, token, self.tree, query, counter),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512(token) => {
                avx2::run::<FastAvx2<_>, C, N>(token.avx2(), token, self.tree, query, counter);
            }
            Isa::Scalar => traverse::run::<FastScalar, C, N>((), self.tree, query, counter),
            #[cfg(not(target_arch = "x86_64"))]
            Isa::Avx2(_) | Isa::Avx512(_) => unreachable!("tokens of x86-64 are made there alone"),
        }
    }
}

impl<const N: usize> ProvenTree<N> {
    /// A tracer over the tree with the best instructions of this machine; it costs nothing to make.
    #[inline]
    pub fn tracer(&self) -> BvhTracer<'_, N> {
        BvhTracer::of_sound(self.sound(), Isa::best())
    }
}

impl<const N: usize> Tracer for BvhTracer<'_, N> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.run(Query::Closest(rays, hits), &mut ());
    }

    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.run(Query::Any(rays, occluded), &mut ());
    }
}
