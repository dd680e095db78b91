//! Vectors of floats for kernels that are written once and compiled for several instruction sets.
//!
//! A kernel is generic over [`Lanes`], which the tokens of instruction sets implement: who has a token may use its
//! vectors. [`Lanes::run`] compiles a kernel for the instruction set; its functions are `#[inline(always)]`, so
//! that they become part of what is compiled so.

#![allow(unsafe_code)]

use super::Avx512;

/// Vectors of [`Lanes::N`] floats, implemented by the proof that the processor has them.
// Elsewhere nobody makes a proof; some of this is for kernels that are compiled for x86-64 alone.
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
pub(crate) trait Lanes: Copy {
    /// The floats.
    type F: Copy;
    /// One truth value per lane.
    type M: Copy;
    /// Number of lanes.
    const N: usize;

    /// Calls `f`, compiled for the instruction set. Pass `#[inline(always)] || ...`.
    fn run<R>(self, f: impl FnOnce() -> R) -> R;
    /// `x` in all lanes.
    fn splat(self, x: f32) -> Self::F;
    /// The first [`Lanes::N`] of `x`.
    fn load(self, x: &[f32; 16]) -> Self::F;
    /// Writes the lanes, the first first; elements beyond [`Lanes::N`] are left as they are.
    fn store(self, x: Self::F, to: &mut [f32; 16]);
    /// `a + b`.
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a - b`.
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a * b`.
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a * b + c`, rounded once.
    fn fmadd(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `a * b - c`, rounded once.
    fn fmsub(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `c - a * b`, rounded once.
    fn fnmadd(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// The processor's estimate of `1 / x`: to 14 bits with sixteen lanes, else to 12.
    fn reciprocal(self, x: Self::F) -> Self::F;
    /// `x` with the sign bit of `sign` flipped into its own.
    fn flip(self, x: Self::F, sign: Self::F) -> Self::F;
    /// The lesser; `b` if they are equal or either is no number.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The greater; `b` if they are equal or either is no number.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// The least of all lanes.
    fn least(self, x: Self::F) -> f32;
    /// A bit for each lane, the first the lowest.
    fn bits(self, m: Self::M) -> u32;
    /// `x` rounded down.
    fn floor(self, x: Self::F) -> Self::F;
    /// `a < b`.
    fn lt(self, a: Self::F, b: Self::F) -> Self::M;
    /// `a <= b`.
    fn le(self, a: Self::F, b: Self::F) -> Self::M;
    /// Both.
    fn and(self, a: Self::M, b: Self::M) -> Self::M;
    /// Either.
    fn or(self, a: Self::M, b: Self::M) -> Self::M;
    /// The other lanes.
    fn not(self, m: Self::M) -> Self::M;
    /// `a` where `m`, else `b`.
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F;
    /// One more than the count `n` where `m`, else `n`. Counts begin with zeros; only [`Lanes::counted`] reads them.
    fn count_where(self, m: Self::M, n: Self::F) -> Self::F;
    /// Counts as floats.
    #[inline(always)]
    fn counted(self, n: Self::F) -> Self::F {
        n
    }
    /// The lesser of `a` and `x` where `m`, else `a`.
    fn min_where(self, m: Self::M, a: Self::F, x: Self::F) -> Self::F;
    /// The greater of `a` and `x` where `m`, else `a`.
    fn max_where(self, m: Self::M, a: Self::F, x: Self::F) -> Self::F;
}

/// Eight lanes of AVX-512: half as much work for each as sixteen.
#[derive(Clone, Copy)]
pub(crate) struct Avx512Half(pub Avx512);

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Avx512, Avx512Half, Lanes};
    use crate::simd::Avx2;
    use std::arch::x86_64::*;

    /// Methods whose bodies are intrinsics.
    macro_rules! methods {
        ($($name:ident($($arg:ident: $type:ty),*) -> $result:ty, $body:expr;)*) => {
            $(
                #[inline(always)]
                fn $name(self, $($arg: $type),*) -> $result {
                    // SAFETY: `self` proves that the processor has the instructions; loads and stores are of arrays
                    // that hold as many floats.
                    unsafe { $body }
                }
            )*
        };
    }

    /// Methods of masks that are integers.
    macro_rules! integer_masks {
        ($mask:ty) => {
            #[inline(always)]
            fn bits(self, m: $mask) -> u32 {
                u32::from(m)
            }

            #[inline(always)]
            fn and(self, a: $mask, b: $mask) -> $mask {
                a & b
            }

            #[inline(always)]
            fn or(self, a: $mask, b: $mask) -> $mask {
                a | b
            }

            #[inline(always)]
            fn not(self, m: $mask) -> $mask {
                !m
            }
        };
    }

    /// Arithmetic of eight lanes, the same with either instruction set.
    macro_rules! eight_lanes {
        ($token:ident, $run:expr) => {
            type F = __m256;
            const N: usize = 8;

            #[inline(always)]
            fn run<R>(self, f: impl FnOnce() -> R) -> R {
                let $token = self;
                $run.run(f)
            }

            methods! {
                splat(x: f32) -> __m256, _mm256_set1_ps(x);
                load(x: &[f32; 16]) -> __m256, _mm256_loadu_ps(x.as_ptr());
                store(x: __m256, to: &mut [f32; 16]) -> (), _mm256_storeu_ps(to.as_mut_ptr(), x);
                add(a: __m256, b: __m256) -> __m256, _mm256_add_ps(a, b);
                sub(a: __m256, b: __m256) -> __m256, _mm256_sub_ps(a, b);
                mul(a: __m256, b: __m256) -> __m256, _mm256_mul_ps(a, b);
                fmadd(a: __m256, b: __m256, c: __m256) -> __m256, _mm256_fmadd_ps(a, b, c);
                fmsub(a: __m256, b: __m256, c: __m256) -> __m256, _mm256_fmsub_ps(a, b, c);
                fnmadd(a: __m256, b: __m256, c: __m256) -> __m256, _mm256_fnmadd_ps(a, b, c);
                reciprocal(x: __m256) -> __m256, _mm256_rcp_ps(x);
                flip(x: __m256, sign: __m256) -> __m256,
                    _mm256_xor_ps(x, _mm256_and_ps(sign, _mm256_set1_ps(-0.0)));
                min(a: __m256, b: __m256) -> __m256, _mm256_min_ps(a, b);
                max(a: __m256, b: __m256) -> __m256, _mm256_max_ps(a, b);
                floor(x: __m256) -> __m256, _mm256_floor_ps(x);
                least(x: __m256) -> f32, {
                    let half = _mm_min_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x));
                    let pair = _mm_min_ps(half, _mm_movehl_ps(half, half));
                    _mm_cvtss_f32(_mm_min_ss(pair, _mm_shuffle_ps::<1>(pair, pair)))
                };
            }
        };
    }

    /// All bits inverted.
    ///
    /// # Safety
    /// The processor has AVX2.
    #[inline(always)]
    unsafe fn inverted(m: __m256) -> __m256 {
        // SAFETY: the caller's argument.
        unsafe { _mm256_xor_ps(m, _mm256_castsi256_ps(_mm256_set1_epi32(-1))) }
    }

    impl Lanes for Avx512 {
        type F = __m512;
        type M = __mmask16;
        const N: usize = 16;

        #[inline(always)]
        fn run<R>(self, f: impl FnOnce() -> R) -> R {
            Avx512::run(self, f)
        }

        integer_masks!(__mmask16);
        methods! {
            splat(x: f32) -> __m512, _mm512_set1_ps(x);
            load(x: &[f32; 16]) -> __m512, _mm512_loadu_ps(x.as_ptr());
            store(x: __m512, to: &mut [f32; 16]) -> (), _mm512_storeu_ps(to.as_mut_ptr(), x);
            add(a: __m512, b: __m512) -> __m512, _mm512_add_ps(a, b);
            sub(a: __m512, b: __m512) -> __m512, _mm512_sub_ps(a, b);
            mul(a: __m512, b: __m512) -> __m512, _mm512_mul_ps(a, b);
            fmadd(a: __m512, b: __m512, c: __m512) -> __m512, _mm512_fmadd_ps(a, b, c);
            fmsub(a: __m512, b: __m512, c: __m512) -> __m512, _mm512_fmsub_ps(a, b, c);
            fnmadd(a: __m512, b: __m512, c: __m512) -> __m512, _mm512_fnmadd_ps(a, b, c);
            reciprocal(x: __m512) -> __m512, _mm512_rcp14_ps(x);
            flip(x: __m512, sign: __m512) -> __m512, _mm512_xor_ps(x, _mm512_and_ps(sign, _mm512_set1_ps(-0.0)));
            min(a: __m512, b: __m512) -> __m512, _mm512_min_ps(a, b);
            max(a: __m512, b: __m512) -> __m512, _mm512_max_ps(a, b);
            least(x: __m512) -> f32, _mm512_reduce_min_ps(x);
            floor(x: __m512) -> __m512, _mm512_roundscale_ps::<_MM_FROUND_TO_NEG_INF>(x);
            lt(a: __m512, b: __m512) -> __mmask16, _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b);
            le(a: __m512, b: __m512) -> __mmask16, _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b);
            select(m: __mmask16, a: __m512, b: __m512) -> __m512, _mm512_mask_mov_ps(b, m, a);
            count_where(m: __mmask16, n: __m512) -> __m512, _mm512_mask_add_ps(n, m, n, _mm512_set1_ps(1.0));
            min_where(m: __mmask16, a: __m512, x: __m512) -> __m512, _mm512_mask_min_ps(a, m, a, x);
            max_where(m: __mmask16, a: __m512, x: __m512) -> __m512, _mm512_mask_max_ps(a, m, a, x);
        }
    }

    impl Lanes for Avx512Half {
        type M = __mmask8;

        eight_lanes!(token, token.0);
        integer_masks!(__mmask8);
        methods! {
            lt(a: __m256, b: __m256) -> __mmask8, _mm256_cmp_ps_mask::<_CMP_LT_OQ>(a, b);
            le(a: __m256, b: __m256) -> __mmask8, _mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b);
            select(m: __mmask8, a: __m256, b: __m256) -> __m256, _mm256_mask_mov_ps(b, m, a);
            count_where(m: __mmask8, n: __m256) -> __m256, _mm256_mask_add_ps(n, m, n, _mm256_set1_ps(1.0));
            min_where(m: __mmask8, a: __m256, x: __m256) -> __m256, _mm256_mask_min_ps(a, m, a, x);
            max_where(m: __mmask8, a: __m256, x: __m256) -> __m256, _mm256_mask_max_ps(a, m, a, x);
        }
    }

    impl Lanes for Avx2 {
        type M = __m256;

        eight_lanes!(token, token);
        methods! {
            bits(m: __m256) -> u32, _mm256_movemask_ps(m) as u32;
            lt(a: __m256, b: __m256) -> __m256, _mm256_cmp_ps::<_CMP_LT_OQ>(a, b);
            le(a: __m256, b: __m256) -> __m256, _mm256_cmp_ps::<_CMP_LE_OQ>(a, b);
            and(a: __m256, b: __m256) -> __m256, _mm256_and_ps(a, b);
            or(a: __m256, b: __m256) -> __m256, _mm256_or_ps(a, b);
            not(m: __m256) -> __m256, inverted(m);
            select(m: __m256, a: __m256, b: __m256) -> __m256, _mm256_blendv_ps(b, a, m);
            // Integers, as all bits of a mask are those of -1.
            count_where(m: __m256, n: __m256) -> __m256,
                _mm256_castsi256_ps(_mm256_sub_epi32(_mm256_castps_si256(n), _mm256_castps_si256(m)));
            counted(n: __m256) -> __m256, _mm256_cvtepi32_ps(_mm256_castps_si256(n));
            // Where not m, x becomes NaN, and the second operand is the result.
            min_where(m: __m256, a: __m256, x: __m256) -> __m256, _mm256_min_ps(_mm256_or_ps(x, inverted(m)), a);
            max_where(m: __m256, a: __m256, x: __m256) -> __m256, _mm256_max_ps(_mm256_or_ps(x, inverted(m)), a);
        }
    }

    impl Avx2 {
        /// Deposits the low bits of `x` where `mask` has ones (BMI2).
        #[inline(always)]
        pub(crate) fn deposit(self, x: u32, mask: u32) -> u32 {
            // SAFETY: the token proves BMI2.
            unsafe { _pdep_u32(x, mask) }
        }
    }
}
