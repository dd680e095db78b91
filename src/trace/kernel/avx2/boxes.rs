//! The children whose boxes a ray meets.

#![allow(unsafe_code)]

use crate::bvh::WideNode;
use crate::bvh::limits::check_width;
use crate::trace::kernel::traverse::Entries;
use std::arch::x86_64::*;

/// A ray as boxes see it.
#[derive(Clone, Copy)]
pub(super) struct Slabs {
    rdir: [f32; 3],
    /// The origin times `rdir`, for the planes met first and for those met last.
    org_rdir: [[f32; 3]; 2],
    /// Offsets of the planes met first, in planes from a node's start: 0 or 3.
    near: [usize; 3],
    tnear: f32,
}

impl Slabs {
    /// The ray of reciprocal direction `rdir` and start `tnear`, which is not negative.
    #[inline(always)]
    pub(super) fn new(rdir: [f32; 3], org_rdir: [[f32; 3]; 2], tnear: f32) -> Self {
        Self { rdir, org_rdir, near: rdir.map(|x| if x >= 0.0 { 0 } else { 3 }), tnear }
    }

    /// The same where it is known which planes are met first: by axis, whether the upper one is.
    #[inline(always)]
    pub(super) fn of_sides(
        rdir: [f32; 3],
        org_rdir: [[f32; 3]; 2],
        upper_first: [bool; 3],
        tnear: f32,
    ) -> Self {
        Self { rdir, org_rdir, near: upper_first.map(|upper| 3 * usize::from(upper)), tnear }
    }

    /// Start of the interval.
    #[inline(always)]
    pub(super) fn tnear(&self) -> f32 {
        self.tnear
    }

    /// The children whose boxes meet the ray up to `tfar`, as a bit mask, and where it enters them.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn meet<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>) {
        const { check_width::<N>() };
        let planes = std::ptr::from_ref(node).cast::<f32>();
        let mut entries = Entries([0; N]);
        let mask = match N {
            4 => {
                let plane = |axis: usize, side: usize, org_rdir: [f32; 3]| {
                    // SAFETY: axis < 3 and side is 0 or 3: one of the node's six planes of four floats.
                    let plane = unsafe { _mm_load_ps(planes.add(4 * (axis + side))) };
                    let org_rdir = _mm_set1_ps(org_rdir[axis]);
                    _mm_castps_si128(_mm_fmsub_ps(plane, _mm_set1_ps(self.rdir[axis]), org_rdir))
                };
                let first = |axis: usize| plane(axis, self.near[axis], self.org_rdir[0]);
                let last = |axis: usize| plane(axis, 3 - self.near[axis], self.org_rdir[1]);
                // Integer comparisons order floats where at least one is not negative, as tnear is.
                let tnear = _mm_castps_si128(_mm_set1_ps(self.tnear));
                let tfar = _mm_castps_si128(_mm_set1_ps(tfar));
                let enter = _mm_max_epi32(_mm_max_epi32(first(0), first(1)), _mm_max_epi32(first(2), tnear));
                let leave = _mm_min_epi32(_mm_min_epi32(last(0), last(1)), _mm_min_epi32(last(2), tfar));
                // SAFETY: N = 4 integers, aligned to 32 bytes.
                unsafe { _mm_store_si128(entries.0.as_mut_ptr().cast(), enter) };
                let missed = _mm_movemask_ps(_mm_castsi128_ps(_mm_cmpgt_epi32(enter, leave)));
                missed as u32 ^ 0xf
            }
            // 8, as is asserted.
            _ => {
                let plane = |axis: usize, side: usize, org_rdir: [f32; 3]| {
                    // SAFETY: axis < 3 and side is 0 or 3: one of the node's six planes of eight floats.
                    let plane = unsafe { _mm256_load_ps(planes.add(8 * (axis + side))) };
                    let org_rdir = _mm256_set1_ps(org_rdir[axis]);
                    _mm256_castps_si256(_mm256_fmsub_ps(plane, _mm256_set1_ps(self.rdir[axis]), org_rdir))
                };
                let first = |axis: usize| plane(axis, self.near[axis], self.org_rdir[0]);
                let last = |axis: usize| plane(axis, 3 - self.near[axis], self.org_rdir[1]);
                let tnear = _mm256_castps_si256(_mm256_set1_ps(self.tnear));
                let tfar = _mm256_castps_si256(_mm256_set1_ps(tfar));
                let enter =
                    _mm256_max_epi32(_mm256_max_epi32(first(0), first(1)), _mm256_max_epi32(first(2), tnear));
                let leave =
                    _mm256_min_epi32(_mm256_min_epi32(last(0), last(1)), _mm256_min_epi32(last(2), tfar));
                // SAFETY: N = 8 integers, aligned to 32 bytes.
                unsafe { _mm256_store_si256(entries.0.as_mut_ptr().cast(), enter) };
                let missed = _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpgt_epi32(enter, leave)));
                missed as u32 ^ 0xff
            }
        };
        (mask, entries)
    }
}

/// Hints that `bytes` from `address` will be read soon.
#[inline(always)]
pub(super) fn prefetch(address: *const u8, bytes: usize) {
    for line in (0..bytes).step_by(64) {
        // SAFETY: a prefetch reads nothing and never faults; SSE is part of x86-64.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address.wrapping_add(line).cast()) };
    }
}
