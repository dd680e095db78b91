//! Vectors of floats for kernels that are written once and compiled for several instruction sets.
//!
//! The methods are inlined into functions compiled for the instruction set ([`crate::builders::split::object::lanes`]); outside of
//! such they must not be called.

#![allow(unsafe_code)]

/// A vector of [`Lanes::N`] floats of an instruction set.
pub(crate) trait Lanes {
    /// The floats.
    type F: Copy;
    /// One truth value per lane.
    type M: Copy;
    /// Number of lanes.
    const N: usize;

    /// `x` in all lanes.
    fn splat(x: f32) -> Self::F;
    /// The first [`Lanes::N`] of `x`.
    fn load(x: &[f32; 16]) -> Self::F;
    /// The lanes, the first first; those beyond [`Lanes::N`] are left as they are.
    fn store(x: Self::F, to: &mut [f32; 16]);
    /// `a + b`.
    fn add(a: Self::F, b: Self::F) -> Self::F;
    /// `a - b`.
    fn sub(a: Self::F, b: Self::F) -> Self::F;
    /// `a * b`.
    fn mul(a: Self::F, b: Self::F) -> Self::F;
    /// The greater; `b` if they are equal.
    fn max(a: Self::F, b: Self::F) -> Self::F;
    /// The least of all lanes.
    fn least(x: Self::F) -> f32;
    /// A bit for each lane, the first the lowest.
    fn bits(m: Self::M) -> u32;
    /// `x` rounded down.
    fn floor(x: Self::F) -> Self::F;
    /// `a < b`.
    fn lt(a: Self::F, b: Self::F) -> Self::M;
    /// `a <= b`.
    fn le(a: Self::F, b: Self::F) -> Self::M;
    /// Both.
    fn and(a: Self::M, b: Self::M) -> Self::M;
    /// Either.
    fn or(a: Self::M, b: Self::M) -> Self::M;
    /// The other lanes.
    fn not(m: Self::M) -> Self::M;
    /// `a` where `m`, else `b`.
    fn select(m: Self::M, a: Self::F, b: Self::F) -> Self::F;
    /// The lesser of `a` and `x` where `m`, else `a`.
    fn min_where(m: Self::M, a: Self::F, x: Self::F) -> Self::F;
    /// The greater of `a` and `x` where `m`, else `a`.
    fn max_where(m: Self::M, a: Self::F, x: Self::F) -> Self::F;
}

/// Eight lanes of AVX2.
#[cfg(target_arch = "x86_64")]
pub(crate) struct Avx2;

/// Eight lanes of AVX-512: half as much work for each as sixteen.
#[cfg(target_arch = "x86_64")]
pub(crate) struct Avx512Half;

/// Sixteen lanes of AVX-512.
#[cfg(target_arch = "x86_64")]
pub(crate) struct Avx512;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Avx2, Avx512, Avx512Half, Lanes};
    use std::arch::x86_64::*;

    // SAFETY of all calls below: the methods are inlined into functions with the target feature, which are
    // called only where the processor has it (the module's contract); loads and stores are of arrays that hold
    // as many floats.

    macro_rules! method {
        ($name:ident($($arg:ident: $type:ty),*) -> $result:ty, $body:expr) => {
            #[inline(always)]
            fn $name($($arg: $type),*) -> $result {
                // SAFETY: see above.
                unsafe { $body }
            }
        };
    }

    impl Lanes for Avx512 {
        type F = __m512;
        type M = __mmask16;
        const N: usize = 16;

        method!(splat(x: f32) -> __m512, _mm512_set1_ps(x));
        method!(load(x: &[f32; 16]) -> __m512, _mm512_loadu_ps(x.as_ptr()));
        method!(store(x: __m512, to: &mut [f32; 16]) -> (), _mm512_storeu_ps(to.as_mut_ptr(), x));
        method!(add(a: __m512, b: __m512) -> __m512, _mm512_add_ps(a, b));
        method!(sub(a: __m512, b: __m512) -> __m512, _mm512_sub_ps(a, b));
        method!(mul(a: __m512, b: __m512) -> __m512, _mm512_mul_ps(a, b));
        method!(max(a: __m512, b: __m512) -> __m512, _mm512_max_ps(a, b));
        method!(least(x: __m512) -> f32, _mm512_reduce_min_ps(x));
        method!(floor(x: __m512) -> __m512, _mm512_roundscale_ps::<_MM_FROUND_TO_NEG_INF>(x));
        method!(lt(a: __m512, b: __m512) -> __mmask16, _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b));
        method!(le(a: __m512, b: __m512) -> __mmask16, _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b));
        method!(select(m: __mmask16, a: __m512, b: __m512) -> __m512, _mm512_mask_mov_ps(b, m, a));
        method!(min_where(m: __mmask16, a: __m512, x: __m512) -> __m512, _mm512_mask_min_ps(a, m, a, x));
        method!(max_where(m: __mmask16, a: __m512, x: __m512) -> __m512, _mm512_mask_max_ps(a, m, a, x));

        #[inline(always)]
        fn bits(m: __mmask16) -> u32 {
            u32::from(m)
        }

        #[inline(always)]
        fn and(a: __mmask16, b: __mmask16) -> __mmask16 {
            a & b
        }

        #[inline(always)]
        fn or(a: __mmask16, b: __mmask16) -> __mmask16 {
            a | b
        }

        #[inline(always)]
        fn not(m: __mmask16) -> __mmask16 {
            !m
        }
    }

    impl Lanes for Avx512Half {
        type F = __m256;
        type M = __mmask8;
        const N: usize = 8;

        method!(splat(x: f32) -> __m256, _mm256_set1_ps(x));
        method!(load(x: &[f32; 16]) -> __m256, _mm256_loadu_ps(x.as_ptr()));
        method!(store(x: __m256, to: &mut [f32; 16]) -> (), _mm256_storeu_ps(to.as_mut_ptr(), x));
        method!(add(a: __m256, b: __m256) -> __m256, _mm256_add_ps(a, b));
        method!(sub(a: __m256, b: __m256) -> __m256, _mm256_sub_ps(a, b));
        method!(mul(a: __m256, b: __m256) -> __m256, _mm256_mul_ps(a, b));
        method!(max(a: __m256, b: __m256) -> __m256, _mm256_max_ps(a, b));
        method!(floor(x: __m256) -> __m256, _mm256_floor_ps(x));
        method!(lt(a: __m256, b: __m256) -> __mmask8, _mm256_cmp_ps_mask::<_CMP_LT_OQ>(a, b));
        method!(le(a: __m256, b: __m256) -> __mmask8, _mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b));
        method!(select(m: __mmask8, a: __m256, b: __m256) -> __m256, _mm256_mask_mov_ps(b, m, a));
        method!(min_where(m: __mmask8, a: __m256, x: __m256) -> __m256, _mm256_mask_min_ps(a, m, a, x));
        method!(max_where(m: __mmask8, a: __m256, x: __m256) -> __m256, _mm256_mask_max_ps(a, m, a, x));

        #[inline(always)]
        fn least(x: __m256) -> f32 {
            Avx2::least(x)
        }

        #[inline(always)]
        fn bits(m: __mmask8) -> u32 {
            u32::from(m)
        }

        #[inline(always)]
        fn and(a: __mmask8, b: __mmask8) -> __mmask8 {
            a & b
        }

        #[inline(always)]
        fn or(a: __mmask8, b: __mmask8) -> __mmask8 {
            a | b
        }

        #[inline(always)]
        fn not(m: __mmask8) -> __mmask8 {
            !m
        }
    }

    impl Lanes for Avx2 {
        type F = __m256;
        type M = __m256;
        const N: usize = 8;

        method!(splat(x: f32) -> __m256, _mm256_set1_ps(x));
        method!(load(x: &[f32; 16]) -> __m256, _mm256_loadu_ps(x.as_ptr()));
        method!(store(x: __m256, to: &mut [f32; 16]) -> (), _mm256_storeu_ps(to.as_mut_ptr(), x));
        method!(add(a: __m256, b: __m256) -> __m256, _mm256_add_ps(a, b));
        method!(sub(a: __m256, b: __m256) -> __m256, _mm256_sub_ps(a, b));
        method!(mul(a: __m256, b: __m256) -> __m256, _mm256_mul_ps(a, b));
        method!(max(a: __m256, b: __m256) -> __m256, _mm256_max_ps(a, b));
        method!(bits(m: __m256) -> u32, _mm256_movemask_ps(m) as u32);
        method!(floor(x: __m256) -> __m256, _mm256_floor_ps(x));
        method!(lt(a: __m256, b: __m256) -> __m256, _mm256_cmp_ps::<_CMP_LT_OQ>(a, b));
        method!(le(a: __m256, b: __m256) -> __m256, _mm256_cmp_ps::<_CMP_LE_OQ>(a, b));
        method!(and(a: __m256, b: __m256) -> __m256, _mm256_and_ps(a, b));
        method!(or(a: __m256, b: __m256) -> __m256, _mm256_or_ps(a, b));
        method!(not(m: __m256) -> __m256, _mm256_xor_ps(m, _mm256_castsi256_ps(_mm256_set1_epi32(-1))));
        method!(select(m: __m256, a: __m256, b: __m256) -> __m256, _mm256_blendv_ps(b, a, m));
        method!(least(x: __m256) -> f32, {
            let half = _mm_min_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x));
            let pair = _mm_min_ps(half, _mm_movehl_ps(half, half));
            _mm_cvtss_f32(_mm_min_ss(pair, _mm_shuffle_ps::<1>(pair, pair)))
        });
        // Where not m, x becomes NaN, and the second operand is the result.
        method!(min_where(m: __m256, a: __m256, x: __m256) -> __m256, _mm256_min_ps(_mm256_or_ps(x, Self::not(m)), a));
        method!(max_where(m: __m256, a: __m256, x: __m256) -> __m256, _mm256_max_ps(_mm256_or_ps(x, Self::not(m)), a));
    }
}
