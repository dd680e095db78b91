//! The tests with AVX2 and FMA, in the operation order of Embree's single-ray kernels for `triangle4`
//! leaves, so that on the same processor the same tree gives the same bits.

#![allow(unsafe_code)]

use super::counts::Counter;
use super::scalar::SMALLEST_DIRECTION;
use super::sound_tree::SoundTree;
use super::traverse::{self, Entries, Kernel, Query};
use crate::bvh::{TriangleBlock, WideNode};
use crate::geometry::{Hit, Ray};
use crate::simd::Avx2;
use std::arch::x86_64::*;

/// [`traverse::run`] compiled for AVX2.
pub(super) fn run<C: Counter, const N: usize>(
    token: Avx2,
    tree: SoundTree<'_, N>,
    query: Query<'_>,
    counter: &mut C,
) {
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
    fn enabled<C: Counter, const N: usize>(
        token: Avx2,
        tree: SoundTree<'_, N>,
        query: Query<'_>,
        counter: &mut C,
    ) {
        traverse::run::<Avx2Kernel, C, N>(token, tree, query, counter);
    }
    // SAFETY: the token proves that the processor has the features.
    unsafe { enabled(token, tree, query, counter) }
}

/// A prepared ray.
#[derive(Clone, Copy)]
struct Avx2Kernel {
    /// Proves the features that the tests are compiled for.
    _token: Avx2,
    org: [f32; 3],
    dir: [f32; 3],
    rdir: [f32; 3],
    org_rdir: [f32; 3],
    /// Offsets of the planes met first, in planes from a node's start: 0 or 3.
    near: [usize; 3],
    tnear: f32,
}

impl Kernel for Avx2Kernel {
    type Token = Avx2;

    #[inline(always)]
    fn new(token: Avx2, ray: &Ray) -> Self {
        // SAFETY: the token proves the features.
        unsafe { Self::prepared(token, ray) }
    }

    #[inline(always)]
    fn enter<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>) {
        // SAFETY: `self._token` proves the features.
        unsafe { self.boxes_met(node, tfar) }
    }

    #[inline(always)]
    fn closest(&self, block: &TriangleBlock, hit: &mut Hit) {
        // SAFETY: `self._token` proves the features.
        unsafe { self.closest_in(block, hit) }
    }

    #[inline(always)]
    fn any(&self, block: &TriangleBlock, tfar: f32) -> bool {
        // SAFETY: `self._token` proves the features.
        unsafe { self.any_in(block, tfar) }
    }

    #[inline(always)]
    fn prefetch(address: *const u8, bytes: usize) {
        for line in (0..bytes).step_by(64) {
            // SAFETY: a prefetch reads nothing and never faults; SSE is part of x86-64.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(address.wrapping_add(line).cast()) };
        }
    }
}

/// Four intersections before the division by `den`; `valid` is a lane mask with at least one lane set.
struct Crossing {
    t: __m128,
    u: __m128,
    v: __m128,
    den: __m128,
    valid: __m128,
}

impl Avx2Kernel {
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn prepared(token: Avx2, ray: &Ray) -> Self {
        let org = ray.org.to_array();
        let dir = ray.dir.to_array();
        let safe = dir.map(|x| if x.abs() < SMALLEST_DIRECTION { SMALLEST_DIRECTION } else { x });
        let rdir: [f32; 4] = array(reciprocal(_mm_setr_ps(safe[0], safe[1], safe[2], 1.0)));
        let rdir = [rdir[0], rdir[1], rdir[2]];
        Self {
            _token: token,
            org,
            dir,
            rdir,
            org_rdir: [org[0] * rdir[0], org[1] * rdir[1], org[2] * rdir[2]],
            near: rdir.map(|x| if x >= 0.0 { 0 } else { 3 }),
            tnear: if ray.tnear > 0.0 { ray.tnear } else { 0.0 },
        }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn boxes_met<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>) {
        let planes = std::ptr::from_ref(node).cast::<f32>();
        let mut entries = Entries([0; N]);
        let mask = match N {
            4 => {
                let plane = |axis: usize, side: usize| {
                    // SAFETY: axis < 3 and side is 0 or 3: one of the node's six planes of four floats.
                    let plane = unsafe { _mm_load_ps(planes.add(4 * (axis + side))) };
                    let org_rdir = _mm_set1_ps(self.org_rdir[axis]);
                    _mm_castps_si128(_mm_fmsub_ps(plane, _mm_set1_ps(self.rdir[axis]), org_rdir))
                };
                let near = |axis: usize| plane(axis, self.near[axis]);
                let far = |axis: usize| plane(axis, 3 - self.near[axis]);
                // Integer comparisons order floats where at least one is not negative, as tnear is.
                let tnear = _mm_castps_si128(_mm_set1_ps(self.tnear));
                let tfar = _mm_castps_si128(_mm_set1_ps(tfar));
                let enter = _mm_max_epi32(_mm_max_epi32(near(0), near(1)), _mm_max_epi32(near(2), tnear));
                let leave = _mm_min_epi32(_mm_min_epi32(far(0), far(1)), _mm_min_epi32(far(2), tfar));
                // SAFETY: N = 4 integers, aligned to 32 bytes.
                unsafe { _mm_store_si128(entries.0.as_mut_ptr().cast(), enter) };
                let missed = _mm_movemask_ps(_mm_castsi128_ps(_mm_cmpgt_epi32(enter, leave)));
                missed as u32 ^ 0xf
            }
            8 => {
                let plane = |axis: usize, side: usize| {
                    // SAFETY: axis < 3 and side is 0 or 3: one of the node's six planes of eight floats.
                    let plane = unsafe { _mm256_load_ps(planes.add(8 * (axis + side))) };
                    let org_rdir = _mm256_set1_ps(self.org_rdir[axis]);
                    _mm256_castps_si256(_mm256_fmsub_ps(plane, _mm256_set1_ps(self.rdir[axis]), org_rdir))
                };
                let near = |axis: usize| plane(axis, self.near[axis]);
                let far = |axis: usize| plane(axis, 3 - self.near[axis]);
                let tnear = _mm256_castps_si256(_mm256_set1_ps(self.tnear));
                let tfar = _mm256_castps_si256(_mm256_set1_ps(tfar));
                let enter =
                    _mm256_max_epi32(_mm256_max_epi32(near(0), near(1)), _mm256_max_epi32(near(2), tnear));
                let leave =
                    _mm256_min_epi32(_mm256_min_epi32(far(0), far(1)), _mm256_min_epi32(far(2), tfar));
                // SAFETY: N = 8 integers, aligned to 32 bytes.
                unsafe { _mm256_store_si256(entries.0.as_mut_ptr().cast(), enter) };
                let missed = _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpgt_epi32(enter, leave)));
                missed as u32 ^ 0xff
            }
            _ => {
                let mut mask = 0;
                for slot in 0..N {
                    let (mut enter, mut leave) = (self.tnear, tfar);
                    for axis in 0..3 {
                        let planes = [node.lower[axis][slot], node.upper[axis][slot]];
                        let (near, far) = if self.near[axis] == 0 { (0, 1) } else { (1, 0) };
                        enter = enter.max(planes[near].mul_add(self.rdir[axis], -self.org_rdir[axis]));
                        leave = leave.min(planes[far].mul_add(self.rdir[axis], -self.org_rdir[axis]));
                    }
                    entries.0[slot] = enter.to_bits();
                    mask |= u32::from(enter <= leave) << slot;
                }
                mask
            }
        };
        (mask, entries)
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn closest_in(&self, block: &TriangleBlock, hit: &mut Hit) {
        let Some(crossing) = self.cross(block, hit.t) else { return };
        let scale = reciprocal(crossing.den);
        let t = _mm_mul_ps(crossing.t, scale);
        // The lowest lane among the closest.
        let candidates = _mm_blendv_ps(_mm_set1_ps(f32::INFINITY), t, crossing.valid);
        let swapped = _mm_min_ps(candidates, _mm_shuffle_ps::<0b10_11_00_01>(candidates, candidates));
        let least = _mm_min_ps(swapped, _mm_shuffle_ps::<0b01_00_11_10>(swapped, swapped));
        let at_least = _mm_and_ps(_mm_cmpeq_ps(candidates, least), crossing.valid);
        let lane = (_mm_movemask_ps(at_least).trailing_zeros() & 3) as usize;
        let one = _mm_set1_ps(1.0);
        *hit = Hit {
            t: array(t)[lane],
            u: array(_mm_min_ps(_mm_mul_ps(crossing.u, scale), one))[lane],
            v: array(_mm_min_ps(_mm_mul_ps(crossing.v, scale), one))[lane],
            prim: block.prims[lane],
        };
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn any_in(&self, block: &TriangleBlock, tfar: f32) -> bool {
        self.cross(block, tfar).is_some()
    }

    /// Moeller and Trumbore's test with the normal `e2 x e1`, edges included, both faces.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn cross(&self, block: &TriangleBlock, tfar: f32) -> Option<Crossing> {
        let zero = _mm_setzero_ps();
        let (v0, e1, e2) = (load(&block.v0), load(&block.e1), load(&block.e2));
        let (org, dir) = (self.org.map(|x| _mm_set1_ps(x)), self.dir.map(|x| _mm_set1_ps(x)));
        let c = [_mm_sub_ps(v0[0], org[0]), _mm_sub_ps(v0[1], org[1]), _mm_sub_ps(v0[2], org[2])];
        let r = cross(c, dir);
        let normal = cross(e2, e1);
        let den = dot(normal, dir);
        let minus = _mm_set1_ps(-0.0);
        let sign = _mm_and_ps(den, minus);
        let abs_den = _mm_andnot_ps(minus, den);
        let u = _mm_xor_ps(dot(r, e2), sign);
        let v = _mm_xor_ps(dot(r, e1), sign);
        let inside = _mm_and_ps(
            _mm_and_ps(_mm_cmpneq_ps(den, zero), _mm_cmpge_ps(u, zero)),
            _mm_and_ps(_mm_cmpge_ps(v, zero), _mm_cmple_ps(_mm_add_ps(u, v), abs_den)),
        );
        if _mm_movemask_ps(inside) == 0 {
            return None;
        }
        let t = _mm_xor_ps(dot(normal, c), sign);
        let beyond = _mm_cmplt_ps(_mm_mul_ps(abs_den, _mm_set1_ps(self.tnear)), t);
        let before = _mm_cmple_ps(t, _mm_mul_ps(abs_den, _mm_set1_ps(tfar)));
        let valid = _mm_and_ps(inside, _mm_and_ps(beyond, before));
        if _mm_movemask_ps(valid) == 0 {
            return None;
        }
        Some(Crossing { t, u, v, den: abs_den, valid })
    }
}

/// The processor's estimate of `1 / x` and one step of Newton's method, as Embree divides.
#[inline]
#[target_feature(enable = "avx2,fma")]
fn reciprocal(x: __m128) -> __m128 {
    let estimate = _mm_rcp_ps(x);
    _mm_fmadd_ps(estimate, _mm_fnmadd_ps(x, estimate, _mm_set1_ps(1.0)), estimate)
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn cross(a: [__m128; 3], b: [__m128; 3]) -> [__m128; 3] {
    [
        _mm_fmsub_ps(a[1], b[2], _mm_mul_ps(a[2], b[1])),
        _mm_fmsub_ps(a[2], b[0], _mm_mul_ps(a[0], b[2])),
        _mm_fmsub_ps(a[0], b[1], _mm_mul_ps(a[1], b[0])),
    ]
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn dot(a: [__m128; 3], b: [__m128; 3]) -> __m128 {
    _mm_fmadd_ps(a[0], b[0], _mm_fmadd_ps(a[1], b[1], _mm_mul_ps(a[2], b[2])))
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn load(planes: &[[f32; 4]; 3]) -> [__m128; 3] {
    // SAFETY: each plane is four floats; unaligned loads have no further demand.
    planes.each_ref().map(|plane| unsafe { _mm_loadu_ps(plane.as_ptr()) })
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn array(x: __m128) -> [f32; 4] {
    let mut out = [0.0; 4];
    // SAFETY: `out` has room for four floats.
    unsafe { _mm_storeu_ps(out.as_mut_ptr(), x) };
    out
}
