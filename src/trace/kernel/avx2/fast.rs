//! The fast tests: boxes as they are, triangles by Moeller and Trumbore over corner and edges.

#![allow(unsafe_code)]

use super::boxes::{Slabs, prefetch};
use super::crossing::{Crossing, Reciprocal, array, reciprocal};
use crate::bvh::{TriangleBlock, WideNode};
use crate::geometry::{Hit, Ray};
use crate::trace::kernel::scalar::SMALLEST_DIRECTION;
use crate::trace::kernel::traverse::{Entries, Kernel};
use std::arch::x86_64::*;

/// A prepared ray. On processors with AVX-512 the tests differ in the estimate of reciprocals alone: masks in
/// registers of their own took longer than AVX2's on a Zen 4; other processors were not tried.
#[derive(Clone, Copy)]
pub(in crate::trace::kernel) struct FastAvx2<R> {
    /// Proves the features that the tests are compiled for.
    pub(super) token: R,
    pub(super) slabs: Slabs,
    pub(super) org: [f32; 3],
    pub(super) dir: [f32; 3],
}

impl<R: Reciprocal> Kernel for FastAvx2<R> {
    type Setup = R;
    type Block = TriangleBlock;

    #[inline(always)]
    fn new(token: R, ray: &Ray) -> Self {
        // SAFETY: the token proves the features.
        unsafe { Self::prepared(token, ray) }
    }

    #[inline(always)]
    fn enter<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>) {
        // SAFETY: `self.token` proves the features.
        unsafe { self.slabs.meet(node, tfar) }
    }

    #[inline(always)]
    fn closest(&self, block: &TriangleBlock, hit: &mut Hit) {
        // SAFETY: `self.token` proves the features.
        unsafe {
            if let Some(crossing) = self.cross(block, hit.t) {
                crossing.closest(reciprocal(self.token, crossing.den), &block.prims, hit);
            }
        }
    }

    #[inline(always)]
    fn any(&self, block: &TriangleBlock, tfar: f32) -> bool {
        // SAFETY: `self.token` proves the features.
        unsafe { self.cross(block, tfar).is_some() }
    }

    #[inline(always)]
    fn prefetch(address: *const u8, bytes: usize) {
        prefetch(address, bytes);
    }
}

impl<R: Reciprocal> FastAvx2<R> {
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn prepared(token: R, ray: &Ray) -> Self {
        let org = ray.org.to_array();
        let dir = ray.dir.to_array();
        let safe = dir.map(|x| if x.abs() < SMALLEST_DIRECTION { SMALLEST_DIRECTION } else { x });
        let rdir: [f32; 4] = array(reciprocal(token, _mm_setr_ps(safe[0], safe[1], safe[2], 1.0)));
        let rdir = [rdir[0], rdir[1], rdir[2]];
        let org_rdir = [org[0] * rdir[0], org[1] * rdir[1], org[2] * rdir[2]];
        let tnear = if ray.tnear > 0.0 { ray.tnear } else { 0.0 };
        Self { token, slabs: Slabs::new(rdir, [org_rdir; 2], tnear), org, dir }
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
            _mm_and_ps(_mm_cmpge_ps(u, zero), _mm_cmpge_ps(v, zero)),
            _mm_cmple_ps(_mm_add_ps(u, v), abs_den),
        );
        // Not left early where no lane is inside: whether one is cannot be foreseen, and the rest takes less time than
        // a wrong guess.
        let t = _mm_xor_ps(dot(normal, c), sign);
        let beyond = _mm_cmplt_ps(_mm_mul_ps(abs_den, _mm_set1_ps(self.slabs.tnear())), t);
        // Both fail where `den` is zero: no distance is beyond 0 and up to 0.
        let before = _mm_cmple_ps(t, _mm_mul_ps(abs_den, _mm_set1_ps(tfar)));
        let valid = _mm_and_ps(inside, _mm_and_ps(beyond, before));
        (_mm_movemask_ps(valid) != 0).then_some(Crossing { t, u, v, den: abs_den, valid })
    }
}

/// The normals of a block's triangles, as [`FastAvx2`] computes them.
#[inline(always)]
pub(super) fn normals(block: &TriangleBlock) -> [[f32; 4]; 3] {
    let mut normals = [[0.0; 4]; 3];
    for (axis, normal) in normals.iter_mut().enumerate() {
        let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
        for (lane, out) in normal.iter_mut().enumerate() {
            *out = block.e2[y][lane].mul_add(block.e1[z][lane], -(block.e2[z][lane] * block.e1[y][lane]));
        }
    }
    normals
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
