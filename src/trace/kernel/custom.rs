//! Traversal with a test of the caller's: boxes are tested by our kernels, what leaves hold by a closure, which is
//! compiled into the traversal.

#[cfg(target_arch = "x86_64")]
use super::avx2::FastAvx2;
use super::scalar::FastScalar;
use super::sound_tree::{ProvenTree, SoundTree};
use super::traverse::{self, Entries, Kernel};
use crate::bvh::{IdBlock, LeafBlock as _, WideNode};
use crate::geometry::{Hit, Ray};
use crate::simd::Isa;
use glam::Vec3;
use std::cell::RefCell;

/// One ray whose boxes are tested by `K`, and whose primitives by the caller.
struct Custom<'f, K, F> {
    boxes: K,
    ray: Ray,
    /// Kernels are copied and shared; this one is never borrowed twice at a time, as it cannot get at itself.
    test: &'f RefCell<F>,
}

impl<K: Copy, F> Clone for Custom<'_, K, F> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<K: Copy, F> Copy for Custom<'_, K, F> {}

impl<'f, K: Kernel, F: FnMut(u32, &Ray) -> Option<f32>> Kernel for Custom<'f, K, F> {
    type Setup = (K::Setup, &'f RefCell<F>);
    type Block = IdBlock;

    #[inline(always)]
    fn new((setup, test): Self::Setup, ray: &Ray) -> Self {
        Self { boxes: K::new(setup, ray), ray: *ray, test }
    }

    #[inline(always)]
    fn enter<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>) {
        self.boxes.enter(node, tfar)
    }

    #[inline(always)]
    fn closest(&self, block: &IdBlock, hit: &mut Hit) {
        let test = &mut *self.test.borrow_mut();
        for prim in block.ids() {
            if let Some(t) = self.within(hit.t, |ray| test(prim, ray)) {
                *hit = Hit { t, prim, ..*hit };
            }
        }
    }

    #[inline(always)]
    fn any(&self, block: &IdBlock, tfar: f32) -> bool {
        let test = &mut *self.test.borrow_mut();
        block.ids().any(|prim| self.within(tfar, |ray| test(prim, ray)).is_some())
    }

    #[inline(always)]
    fn prefetch(address: *const u8, bytes: usize) {
        K::prefetch(address, bytes);
    }
}

impl<K, F> Custom<'_, K, F> {
    /// The distance of a hit, if it is in the interval of the ray up to `tfar`.
    #[inline(always)]
    fn within(&self, tfar: f32, test: impl FnOnce(&Ray) -> Option<f32>) -> Option<f32> {
        let ray = Ray { tfar, ..self.ray };
        test(&ray).filter(|&t| (ray.tnear < t) & (t <= tfar) & (t < f32::INFINITY))
    }
}

impl<const N: usize> ProvenTree<N, IdBlock> {
    /// The closest hit of `ray` by `test`, which is given a primitive and the ray up to the closest hit so far, and
    /// returns the distance where it hits. Primitives come about in the order of their boxes along the ray. A
    /// distance out of the ray's interval is no hit. A ray that is not valid, or has no direction, hits nothing.
    #[inline]
    pub fn closest_with(&self, isa: Isa, ray: &Ray, test: impl FnMut(u32, &Ray) -> Option<f32>) -> Hit {
        if ray.is_valid() && ray.dir != Vec3::ZERO { self.with(isa, ray, test, Closest) } else { Hit::MISS }
    }

    /// Whether `ray` hits anything by `test`, likewise; primitives come in any order.
    #[inline]
    pub fn any_with(&self, isa: Isa, ray: &Ray, mut test: impl FnMut(u32, &Ray) -> bool) -> bool {
        // A distance that is in any interval, as there must be one.
        let test = |prim, ray: &Ray| test(prim, ray).then_some(ray.tfar.min(f32::MAX));
        ray.is_valid() && ray.dir != Vec3::ZERO && self.with(isa, ray, test, Any)
    }

    /// Picks the instructions for boxes.
    #[inline]
    fn with<F: FnMut(u32, &Ray) -> Option<f32>, T: Traversal>(
        &self,
        isa: Isa,
        ray: &Ray,
        test: F,
        traversal: T,
    ) -> T::Answer {
        let test = &RefCell::new(test);
        let tree = self.sound();
        match isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(token) => token.run(
                #[inline(always)]
                || traversal.run(Custom::<'_, FastAvx2<_>, F>::new((token, test), ray), tree, ray.tfar),
            ),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512(token) => token.avx2().run(
                #[inline(always)]
                || traversal.run(Custom::<'_, FastAvx2<_>, F>::new((token, test), ray), tree, ray.tfar),
            ),
            Isa::Scalar => traversal.run(Custom::<'_, FastScalar, F>::new(((), test), ray), tree, ray.tfar),
            #[cfg(not(target_arch = "x86_64"))]
            Isa::Avx2(_) | Isa::Avx512(_) => unreachable!("tokens of x86-64 are made there alone"),
        }
    }
}

/// A query of one ray.
pub(super) trait Traversal {
    type Answer;

    fn run<K: Kernel, const N: usize>(
        self,
        ray: K,
        tree: SoundTree<'_, N, K::Block>,
        tfar: f32,
    ) -> Self::Answer;
}

pub(super) struct Closest;

impl Traversal for Closest {
    type Answer = Hit;

    #[inline(always)]
    fn run<K: Kernel, const N: usize>(self, ray: K, tree: SoundTree<'_, N, K::Block>, tfar: f32) -> Hit {
        traverse::closest::<K, (), N>(ray, tree, tfar, &mut ())
    }
}

pub(super) struct Any;

impl Traversal for Any {
    type Answer = bool;

    #[inline(always)]
    fn run<K: Kernel, const N: usize>(self, ray: K, tree: SoundTree<'_, N, K::Block>, tfar: f32) -> bool {
        traverse::any::<K, (), N>(ray, tree, tfar, &mut ())
    }
}
