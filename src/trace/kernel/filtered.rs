//! Traversal that asks the caller about each hit: one that is turned down is as if it were not there, as where a
//! texture cuts holes into a triangle.

#[cfg(target_arch = "x86_64")]
use super::avx2::FastAvx2;
use super::custom::{Any, Closest, Traversal};
use super::scalar::FastScalar;
use super::sound_tree::ProvenTree;
use super::traverse::{Entries, Kernel};
use crate::bvh::{TriangleBlock, WideNode};
use crate::geometry::{Hit, Ray};
use crate::simd::Isa;
use std::cell::RefCell;

/// One ray of `K`, and the caller's answer to its hits.
struct Filtered<'f, K, F> {
    kernel: K,
    /// Kernels are copied and shared; this one is never borrowed twice at a time, as it cannot get at itself.
    accepts: &'f RefCell<F>,
}

impl<K: Copy, F> Clone for Filtered<'_, K, F> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<K: Copy, F> Copy for Filtered<'_, K, F> {}

impl<'f, K: Kernel<Block = TriangleBlock>, F: FnMut(&Hit) -> bool> Kernel for Filtered<'f, K, F> {
    type Setup = (K::Setup, &'f RefCell<F>);
    type Block = TriangleBlock;

    #[inline(always)]
    fn new((setup, accepts): Self::Setup, ray: &Ray) -> Self {
        Self { kernel: K::new(setup, ray), accepts }
    }

    #[inline(always)]
    fn enter<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>) {
        self.kernel.enter(node, tfar)
    }

    #[inline(always)]
    fn closest(&self, block: &TriangleBlock, hit: &mut Hit) {
        if let Some(accepted) = self.accepted(block, hit.t) {
            *hit = accepted;
        }
    }

    #[inline(always)]
    fn any(&self, block: &TriangleBlock, tfar: f32) -> bool {
        self.accepted(block, tfar).is_some()
    }

    #[inline(always)]
    fn prefetch(address: *const u8, bytes: usize) {
        K::prefetch(address, bytes);
    }
}

impl<K: Kernel<Block = TriangleBlock>, F: FnMut(&Hit) -> bool> Filtered<'_, K, F> {
    /// The block's closest hit up to `tfar` that the caller accepts.
    #[inline(always)]
    fn accepted(&self, block: &TriangleBlock, tfar: f32) -> Option<Hit> {
        let mut rest;
        let mut block = block;
        loop {
            let mut hit = Hit { t: tfar, ..Hit::MISS };
            self.kernel.closest(block, &mut hit);
            if !hit.is_hit() {
                return None;
            }
            if (self.accepts.borrow_mut())(&hit) {
                return Some(hit);
            }
            rest = block.without(hit.prim);
            block = &rest;
        }
    }
}

impl<const N: usize> ProvenTree<N> {
    /// The closest hit of `ray` that `accepts` does not turn down, by the instructions of `isa`. It is asked about
    /// hits as traversal finds them, not by distance: about one at most as often as the tree holds its triangle, and
    /// not about those behind one that it has accepted.
    #[inline]
    pub fn closest_filtered(&self, isa: Isa, ray: &Ray, accepts: impl FnMut(&Hit) -> bool) -> Hit {
        if ray.is_valid() { self.filtered(isa, ray, accepts, Closest).measured() } else { Hit::MISS }
    }

    /// Whether `ray` has a hit that `accepts` does not turn down, likewise. A hit without a distance, as the product of
    /// two edges and the direction left the range of `f32`, counts for none.
    #[inline]
    pub fn any_filtered(&self, isa: Isa, ray: &Ray, accepts: impl FnMut(&Hit) -> bool) -> bool {
        ray.is_valid() && self.filtered(isa, ray, accepts, Any)
    }

    #[inline]
    fn filtered<F: FnMut(&Hit) -> bool, T: Traversal>(
        &self,
        isa: Isa,
        ray: &Ray,
        accepts: F,
        traversal: T,
    ) -> T::Answer {
        let accepts = &RefCell::new(accepts);
        let tree = self.sound();
        match isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(token) => token.run(
                #[inline(always)]
                || traversal.run(Filtered::<'_, FastAvx2<_>, F>::new((token, accepts), ray), tree, ray.tfar),
            ),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512(token) => token.avx2().run(
                #[inline(always)]
                || traversal.run(Filtered::<'_, FastAvx2<_>, F>::new((token, accepts), ray), tree, ray.tfar),
            ),
            Isa::Scalar => {
                traversal.run(Filtered::<'_, FastScalar, F>::new(((), accepts), ray), tree, ray.tfar)
            }
            #[cfg(not(target_arch = "x86_64"))]
            Isa::Avx2(_) | Isa::Avx512(_) => unreachable!("tokens of x86-64 are made there alone"),
        }
    }
}
