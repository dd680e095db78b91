//! The watertight tests: padded boxes, sheared corners.

#![allow(unsafe_code)]

use super::boxes::{Slabs, prefetch};
use super::crossing::Crossing;
use crate::bvh::WideNode;
use crate::geometry::{Aabb, Hit, Ray};
use crate::simd::Avx2;
use crate::trace::kernel::corners::CornerBlock;
use crate::trace::kernel::frame::{self, Frame};
use crate::trace::kernel::traverse::{Entries, Kernel};
use std::arch::x86_64::*;

/// A prepared ray.
#[derive(Clone, Copy)]
pub(in crate::trace::kernel) struct WatertightAvx2 {
    /// Proves the features that the tests are compiled for.
    _token: Avx2,
    slabs: Slabs,
    frame: Frame,
}

impl Kernel for WatertightAvx2 {
    /// The instructions, and the bounds of the mesh.
    type Setup = (Avx2, Aabb);
    type Block = CornerBlock;

    #[inline(always)]
    fn scaled(ray: &Ray) -> (Ray, f32) {
        frame::scaled(ray)
    }

    #[inline(always)]
    fn new((token, bounds): (Avx2, Aabb), ray: &Ray) -> Self {
        let frame = Frame::new(ray, bounds);
        let org_rdir = [frame.near_org_rdir, frame.far_org_rdir];
        Self { _token: token, slabs: Slabs::new(frame.rdir, org_rdir, frame.tnear), frame }
    }

    #[inline(always)]
    fn enter<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>) {
        // SAFETY: `self._token` proves the features.
        unsafe { self.slabs.meet(node, tfar) }
    }

    #[inline(always)]
    fn closest(&self, block: &CornerBlock, hit: &mut Hit) {
        // SAFETY: `self._token` proves the features.
        unsafe {
            if let Some(crossing) = self.cross(block, hit.t) {
                // Quotients: an estimate of the reciprocal of one is less than one.
                crossing.closest(_mm_set1_ps(1.0), &block.prims, hit);
            }
        }
    }

    #[inline(always)]
    fn any(&self, block: &CornerBlock, tfar: f32) -> bool {
        // SAFETY: `self._token` proves the features.
        unsafe { self.cross(block, tfar).is_some() }
    }

    #[inline(always)]
    fn prefetch(address: *const u8, bytes: usize) {
        prefetch(address, bytes);
    }
}

impl WatertightAvx2 {
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn cross(&self, block: &CornerBlock, tfar: f32) -> Option<Crossing> {
        let (axes, Frame { org, shear, tnear, .. }) = (self.frame.axes(), self.frame);
        let all = |x: f32| _mm_set1_ps(x);
        // Corners relative to the origin; x and y sheared so that the ray runs along z.
        let corner = |corner: usize| {
            let relative = |axis: usize| {
                // SAFETY: axes are below 3; four floats lie there.
                let plane = unsafe { block.corners[corner].get_unchecked(axes[axis]) };
                // SAFETY: as above.
                _mm_sub_ps(unsafe { _mm_loadu_ps(plane.as_ptr()) }, all(org[axis]))
            };
            let z = relative(2);
            let (x, y) = (relative(0), relative(1));
            [_mm_fnmadd_ps(all(shear[0]), z, x), _mm_fnmadd_ps(all(shear[1]), z, y), z]
        };
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let (u, v, w) = (edge(b, c), edge(c, a), edge(a, b));
        let sum = _mm_add_ps(_mm_add_ps(u, v), w);
        let minus = _mm_set1_ps(-0.0);
        let (sign, den) = (_mm_and_ps(sum, minus), _mm_andnot_ps(minus, sum));
        let (u, v, w) = (_mm_xor_ps(u, sign), _mm_xor_ps(v, sign), _mm_xor_ps(w, sign));
        let zero = _mm_setzero_ps();
        let inside =
            _mm_and_ps(_mm_cmpge_ps(_mm_min_ps(u, _mm_min_ps(v, w)), zero), _mm_cmpneq_ps(den, zero));
        if _mm_movemask_ps(inside) == 0 {
            return None;
        }
        let t = self.distance(block, [a[2], b[2], c[2]]);
        let within = _mm_and_ps(_mm_cmplt_ps(all(tnear), t), _mm_cmple_ps(t, all(tfar)));
        let valid = _mm_and_ps(inside, within);
        let (u, v, den) = (_mm_div_ps(v, den), _mm_div_ps(w, den), all(1.0));
        (_mm_movemask_ps(valid) != 0).then_some(Crossing { t, u, v, den, valid })
    }

    /// Of the triangles' planes along the ray, and never beside their corners, whose `z` are those relative to the
    /// origin: a plane that contains the ray up to rounding is hit, too.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn distance(&self, block: &CornerBlock, z: [__m128; 3]) -> __m128 {
        let (axes, Frame { org, shear, .. }) = (self.frame.axes(), self.frame);
        let all = |x: f32| _mm_set1_ps(x);
        let at = |corner: usize, axis: usize| {
            // SAFETY: axes are below 3; four floats lie there.
            unsafe { _mm_loadu_ps(block.corners[corner].get_unchecked(axes[axis]).as_ptr()) }
        };
        let edge = |corner: usize| {
            let along = |axis: usize| _mm_sub_ps(at(corner, axis), at(0, axis));
            [along(0), along(1), along(2)]
        };
        let (p, q) = (edge(1), edge(2));
        let minor = |i: usize, j: usize| _mm_fmsub_ps(p[i], q[j], _mm_mul_ps(p[j], q[i]));
        let normal = [minor(1, 2), minor(2, 0), minor(0, 1)];
        let (x, y) = (_mm_sub_ps(at(0, 0), all(org[0])), _mm_sub_ps(at(0, 1), all(org[1])));
        let dot = |x: __m128, y: __m128, z: __m128| {
            _mm_fmadd_ps(normal[0], x, _mm_fmadd_ps(normal[1], y, _mm_mul_ps(normal[2], z)))
        };
        let height = dot(x, y, z[0]);
        let approach = dot(all(shear[0]), all(shear[1]), all(1.0));
        // Minimum and maximum return their second operand where the quotient is none.
        let near = _mm_min_ps(z[0], _mm_min_ps(z[1], z[2]));
        let far = _mm_max_ps(z[0], _mm_max_ps(z[1], z[2]));
        let quotient = _mm_div_ps(height, approach);
        _mm_mul_ps(_mm_min_ps(_mm_max_ps(quotient, near), far), all(shear[2]))
    }
}

/// Twice the area of the triangle of the origin and the projected edge from `p` to `q`, with the sign of the exact
/// value: where the rounded products are equal, their errors decide.
#[inline]
#[target_feature(enable = "avx2,fma")]
fn edge(p: [__m128; 3], q: [__m128; 3]) -> __m128 {
    let (left, right) = (_mm_mul_ps(q[0], p[1]), _mm_mul_ps(q[1], p[0]));
    let errors = _mm_sub_ps(_mm_fmsub_ps(q[0], p[1], left), _mm_fmsub_ps(q[1], p[0], right));
    _mm_blendv_ps(_mm_sub_ps(left, right), errors, _mm_cmpeq_ps(left, right))
}
