//! The tests with AVX2 and FMA, in the operation order of Embree's single-ray kernels, so that on the same processor
//! the same tree gives the same bits.
//!
//! [`fast`] and [`watertight`] are the two kernels, [`boxes`] and [`crossing`] what they share; [`packet`] is the
//! first for many rays at a time.

#![allow(unsafe_code)]

mod boxes;
mod crossing;
mod fast;
pub(super) mod packet;
mod watertight;

pub(super) use crossing::Reciprocal;
pub(super) use fast::FastAvx2;
pub(super) use watertight::WatertightAvx2;

use super::counts::Counter;
use super::sound_tree::SoundTree;
use super::traverse::{self, Kernel, Query};
use crate::simd::Avx2;

/// [`traverse::run`] compiled for AVX2.
pub(super) fn run<K: Kernel, C: Counter, const N: usize>(
    _: Avx2,
    setup: K::Setup,
    tree: SoundTree<'_, N, K::Block>,
    query: Query<'_>,
    counter: &mut C,
) {
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn enabled<K: Kernel, C: Counter, const N: usize>(
        setup: K::Setup,
        tree: SoundTree<'_, N, K::Block>,
        query: Query<'_>,
        counter: &mut C,
    ) {
        traverse::run::<K, C, N>(setup, tree, query, counter);
    }
    // SAFETY: the token proves that the processor has the features.
    unsafe { enabled::<K, C, N>(setup, tree, query, counter) }
}
