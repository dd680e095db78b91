//! The triangles of a block that rays of a packet hit.

use super::{MOST, Mask, Packet, load, load3, of, vectors};
use crate::bvh::TriangleBlock;
use crate::geometry::Hit;
use crate::simd::vector::Lanes;
use crate::trace::kernel::avx2::fast::normals;

impl Packet {
    /// Tests `rays` against the triangles of `block`; returns those that have a hit. Unless `ANY`, their hits are
    /// replaced by the closest. Call it within [`Lanes::run`].
    #[inline(always)]
    pub(in crate::trace::kernel) fn hit<L: Lanes, const ANY: bool>(
        &mut self,
        lanes: L,
        block: &TriangleBlock,
        rays: Mask,
        hits: &mut [Hit; MOST],
    ) -> Mask {
        let mut hit = 0;
        let normals = normals(block);
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        for at in vectors::<L>() {
            let alive = of(rays, at, L::N);
            if alive == 0 {
                continue;
            }
            let (org, dir) = (load3(lanes, &self.org, at), load3(lanes, &self.dir, at));
            let (tnear, tfar) = (load(lanes, &self.tnear, at), load(lanes, &self.tfar, at));
            // As for single rays, all four are tested against the interval's end before the block, and then the least
            // distance is taken; backwards, so that of equal ones the first is kept.
            let mut least = lanes.splat(f32::INFINITY);
            for triangle in (0..4).rev() {
                if block.prims[triangle] == Hit::NONE {
                    continue;
                }
                let v0 = of_triangle(lanes, &block.v0, triangle);
                let e1 = of_triangle(lanes, &block.e1, triangle);
                let e2 = of_triangle(lanes, &block.e2, triangle);
                let normal = of_triangle(lanes, &normals, triangle);
                let c = [lanes.sub(v0[0], org[0]), lanes.sub(v0[1], org[1]), lanes.sub(v0[2], org[2])];
                let r = cross(lanes, c, dir);
                let den = dot(lanes, normal, dir);
                let abs_den = lanes.flip(den, den);
                let u = lanes.flip(dot(lanes, r, e2), den);
                let v = lanes.flip(dot(lanes, r, e1), den);
                let t = lanes.flip(dot(lanes, normal, c), den);
                let inside = lanes.and(
                    lanes.and(lanes.lt(zero, abs_den), lanes.le(zero, u)),
                    lanes.and(lanes.le(zero, v), lanes.le(lanes.add(u, v), abs_den)),
                );
                let within =
                    lanes.and(lanes.lt(lanes.mul(abs_den, tnear), t), lanes.le(t, lanes.mul(abs_den, tfar)));
                let valid = lanes.and(inside, within);
                let bits = lanes.bits(valid) & alive as u32;
                hit |= Mask::from(bits) << at;
                if !ANY && bits != 0 {
                    let estimate = lanes.reciprocal(abs_den);
                    let scale = lanes.fmadd(estimate, lanes.fnmadd(abs_den, estimate, one), estimate);
                    let t = lanes.mul(t, scale);
                    let nearer = lanes.and(valid, lanes.le(t, least));
                    least = lanes.select(nearer, t, least);
                    let t = array(lanes, t);
                    let u = array(lanes, lanes.min(lanes.mul(u, scale), one));
                    let v = array(lanes, lanes.min(lanes.mul(v, scale), one));
                    let mut left = lanes.bits(nearer) & alive as u32;
                    while left != 0 {
                        let lane = left.trailing_zeros() as usize % L::N;
                        left &= left - 1;
                        let prim = block.prims[triangle];
                        hits[(at + lane) % MOST] = Hit { t: t[lane], u: u[lane], v: v[lane], prim };
                        self.tfar[at + lane] = t[lane];
                    }
                }
            }
        }
        hit
    }
}

/// A vector of each component of a triangle's.
#[inline(always)]
fn of_triangle<L: Lanes>(lanes: L, [x, y, z]: &[[f32; 4]; 3], triangle: usize) -> [L::F; 3] {
    [lanes.splat(x[triangle]), lanes.splat(y[triangle]), lanes.splat(z[triangle])]
}

#[inline(always)]
fn array<L: Lanes>(lanes: L, x: L::F) -> [f32; 16] {
    let mut out = [0.0; 16];
    lanes.store(x, &mut out);
    out
}

#[inline(always)]
fn cross<L: Lanes>(lanes: L, a: [L::F; 3], b: [L::F; 3]) -> [L::F; 3] {
    [
        lanes.fmsub(a[1], b[2], lanes.mul(a[2], b[1])),
        lanes.fmsub(a[2], b[0], lanes.mul(a[0], b[2])),
        lanes.fmsub(a[0], b[1], lanes.mul(a[1], b[0])),
    ]
}

#[inline(always)]
fn dot<L: Lanes>(lanes: L, a: [L::F; 3], b: [L::F; 3]) -> L::F {
    lanes.fmadd(a[0], b[0], lanes.fmadd(a[1], b[1], lanes.mul(a[2], b[2])))
}
