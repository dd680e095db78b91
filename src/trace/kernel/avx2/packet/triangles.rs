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
        let one = lanes.splat(1.0);
        for at in vectors::<L>() {
            let alive = of(rays, at, L::N);
            if alive == 0 {
                continue;
            }
            let (org, dir) = (load3(lanes, &self.org, at), load3(lanes, &self.dir, at));
            let (tnear, tfar) = (load(lanes, &self.tnear, at), load(lanes, &self.tfar, at));
            // As for single rays, all four are tested against the interval's end before the block, and then the least
            // distance is taken; backwards, so that of equal ones the first is kept.
            let mut least = lanes.splat(f32::MAX);
            for triangle in (0..4).rev() {
                if block.prims[triangle] == Hit::NONE {
                    continue;
                }
                let planes = Planes {
                    v0: of_triangle(lanes, &block.v0, triangle),
                    e1: of_triangle(lanes, &block.e1, triangle),
                    e2: of_triangle(lanes, &block.e2, triangle),
                    normal: of_triangle(lanes, &normals, triangle),
                };
                let Crossings { t, u, v, den, valid } = test(lanes, &planes, org, dir, tnear, tfar);
                let bits = lanes.bits(valid) & alive as u32;
                hit |= Mask::from(bits) << at;
                if !ANY && bits != 0 {
                    let estimate = lanes.reciprocal(den);
                    let scale = lanes.fmadd(estimate, lanes.fnmadd(den, estimate, one), estimate);
                    let t = lanes.mul(t, scale);
                    let positive = lanes.lt(lanes.splat(0.0), t);
                    let nearer = lanes.and(lanes.and(valid, positive), lanes.le(t, least));
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

/// Corner, edges and normal of triangles.
pub(super) struct Planes<F> {
    pub v0: [F; 3],
    pub e1: [F; 3],
    pub e2: [F; 3],
    pub normal: [F; 3],
}

/// Where rays meet triangles, before the division by `den`.
pub(super) struct Crossings<L: Lanes> {
    pub t: L::F,
    pub u: L::F,
    pub v: L::F,
    pub den: L::F,
    /// Whether the ray meets the triangle, in its interval.
    pub valid: L::M,
}

/// The test of `FastAvx2`, a ray and a triangle in each lane.
#[inline(always)]
pub(super) fn test<L: Lanes>(
    lanes: L,
    planes: &Planes<L::F>,
    org: [L::F; 3],
    dir: [L::F; 3],
    tnear: L::F,
    tfar: L::F,
) -> Crossings<L> {
    let Planes { v0, e1, e2, normal } = *planes;
    let zero = lanes.splat(0.0);
    let c = [lanes.sub(v0[0], org[0]), lanes.sub(v0[1], org[1]), lanes.sub(v0[2], org[2])];
    let r = cross(lanes, c, dir);
    let signed = dot(lanes, normal, dir);
    let den = lanes.flip(signed, signed);
    let u = lanes.flip(dot(lanes, r, e2), signed);
    let v = lanes.flip(dot(lanes, r, e1), signed);
    let t = lanes.flip(dot(lanes, normal, c), signed);
    let inside = lanes.and(
        lanes.and(lanes.lt(zero, den), lanes.le(zero, u)),
        lanes.and(lanes.le(zero, v), lanes.le(lanes.add(u, v), den)),
    );
    let within = lanes.and(lanes.lt(lanes.mul(den, tnear), t), lanes.le(t, lanes.mul(den, tfar)));
    Crossings { t, u, v, den, valid: lanes.and(inside, within) }
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
pub(super) fn cross<L: Lanes>(lanes: L, a: [L::F; 3], b: [L::F; 3]) -> [L::F; 3] {
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
