//! Four intersections at once, and the closest of them.

#![allow(unsafe_code)]

use crate::geometry::Hit;
use crate::simd::{Avx2, Avx512};
use std::arch::asm;
use std::arch::x86_64::*;

/// Four intersections before the division by `den`; `valid` is a lane mask with at least one lane set.
pub(super) struct Crossing {
    pub t: __m128,
    pub u: __m128,
    pub v: __m128,
    pub den: __m128,
    pub valid: __m128,
}

impl Crossing {
    /// Replaces `hit` by the closest of the valid lanes, the lowest of equals; `scale` is the reciprocal of what they
    /// are divided by, or 1 where they are quotients already, `prims` are their triangles. A lane whose distance is no
    /// positive number stands back: the products of the test left the range of `f32`, and what lies behind must not be
    /// hidden.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn closest(&self, scale: __m128, prims: &[u32; 4], hit: &mut Hit) {
        let t = _mm_mul_ps(self.t, scale);
        let valid = _mm_and_ps(self.valid, _mm_cmpgt_ps(t, _mm_setzero_ps()));
        let candidates = _mm_blendv_ps(_mm_set1_ps(f32::INFINITY), t, valid);
        let swapped = _mm_min_ps(candidates, _mm_shuffle_ps::<0b10_11_00_01>(candidates, candidates));
        let least = _mm_min_ps(swapped, _mm_shuffle_ps::<0b01_00_11_10>(swapped, swapped));
        if _mm_cvtss_f32(least) == f32::INFINITY {
            return;
        }
        let lanes = _mm_movemask_ps(_mm_cmpeq_ps(candidates, least));
        let lane = (lanes.trailing_zeros() & 3) as usize;
        let one = _mm_set1_ps(1.0);
        *hit = Hit {
            t: _mm_cvtss_f32(least),
            u: array(_mm_min_ps(_mm_mul_ps(self.u, scale), one))[lane],
            v: array(_mm_min_ps(_mm_mul_ps(self.v, scale), one))[lane],
            prim: prims[lane],
        };
    }
}

/// An estimate of reciprocals, by the proof that the processor has it, and AVX2.
pub(in crate::trace::kernel) trait Reciprocal: Copy {
    /// About `1 / x`.
    fn estimate(self, x: __m128) -> __m128;
}

impl Reciprocal for Avx2 {
    /// To 12 bits.
    #[inline(always)]
    fn estimate(self, x: __m128) -> __m128 {
        // SAFETY: the token proves AVX2, and SSE with it.
        unsafe { _mm_rcp_ps(x) }
    }
}

impl Reciprocal for Avx512 {
    /// To 14 bits, as Embree's kernels for AVX-512 have it. Not by the intrinsic, which would have all that it is
    /// inlined into compiled for AVX-512.
    #[inline(always)]
    fn estimate(self, x: __m128) -> __m128 {
        let estimate;
        // SAFETY: the token proves AVX-512 F and VL; the instruction reads and writes registers only.
        unsafe {
            asm!("vrcp14ps {}, {}", lateout(xmm_reg) estimate, in(xmm_reg) x, options(pure, nomem, nostack, preserves_flags));
        }
        estimate
    }
}

/// The processor's estimate of `1 / x` and one step of Newton's method, as Embree divides.
#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn reciprocal(token: impl Reciprocal, x: __m128) -> __m128 {
    let estimate = token.estimate(x);
    _mm_fmadd_ps(estimate, _mm_fnmadd_ps(x, estimate, _mm_set1_ps(1.0)), estimate)
}

#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn array(x: __m128) -> [f32; 4] {
    let mut out = [0.0; 4];
    // SAFETY: `out` has room for four floats.
    unsafe { _mm_storeu_ps(out.as_mut_ptr(), x) };
    out
}
