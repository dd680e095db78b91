//! The portable tests, on plain arrays that the compiler vectorises, without fused operations.
//! The box test is conservative: its far distances are widened by more than the rounding errors of the
//! products (Ize, "Robust BVH Ray Traversal", JCGT 2013).

use super::traverse::{Entries, Kernel};
use crate::bvh::{TriangleBlock, WideNode};
use crate::geometry::{Hit, Ray};

/// Components below this are taken for it, so that their reciprocals are finite and no slab yields NaN.
pub(super) const SMALLEST_DIRECTION: f32 = 1e-18;

/// 1 + 4 ulp: twice Ize's bound, for the rounded reciprocal and the rounded factor.
const WIDEN: f32 = 1.0 + 4.0 * f32::EPSILON;

/// A prepared ray.
#[derive(Clone, Copy)]
pub(super) struct ScalarKernel {
    org: [f32; 3],
    dir: [f32; 3],
    rdir: [f32; 3],
    tnear: f32,
}

impl Kernel for ScalarKernel {
    type Token = ();

    #[inline(always)]
    fn new((): (), ray: &Ray) -> Self {
        let dir = ray.dir.to_array();
        let rdir = dir.map(|x| 1.0 / if x.abs() < SMALLEST_DIRECTION { SMALLEST_DIRECTION } else { x });
        Self { org: ray.org.to_array(), dir, rdir, tnear: greater(ray.tnear, 0.0) }
    }

    #[inline(always)]
    fn enter<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>) {
        let (mut enter, mut leave) = ([self.tnear; N], [tfar; N]);
        for axis in 0..3 {
            let (near, far) = if self.rdir[axis] >= 0.0 {
                (&node.lower[axis], &node.upper[axis])
            } else {
                (&node.upper[axis], &node.lower[axis])
            };
            for slot in 0..N {
                enter[slot] = greater((near[slot] - self.org[axis]) * self.rdir[axis], enter[slot]);
                leave[slot] = smaller((far[slot] - self.org[axis]) * self.rdir[axis] * WIDEN, leave[slot]);
            }
        }
        let mut mask = 0;
        for slot in 0..N {
            mask |= u32::from(enter[slot] <= leave[slot]) << slot;
        }
        (mask, Entries(enter.map(f32::to_bits)))
    }

    #[inline(always)]
    fn closest(&self, block: &TriangleBlock, hit: &mut Hit) {
        let crossing = self.cross(block, hit.t);
        for lane in 0..4 {
            if crossing.valid[lane] {
                let t = crossing.t[lane] / crossing.den[lane];
                let first_or_closer = hit.t > t || !crossing.valid[..lane].contains(&true);
                if first_or_closer {
                    *hit = Hit {
                        t,
                        u: smaller(crossing.u[lane] / crossing.den[lane], 1.0),
                        v: smaller(crossing.v[lane] / crossing.den[lane], 1.0),
                        prim: block.prims[lane],
                    };
                }
            }
        }
    }

    #[inline(always)]
    fn any(&self, block: &TriangleBlock, tfar: f32) -> bool {
        self.cross(block, tfar).valid.contains(&true)
    }

    #[inline(always)]
    fn prefetch(_: *const u8, _: usize) {}
}

/// Four intersections before the division by `den`.
struct Crossing {
    t: [f32; 4],
    u: [f32; 4],
    v: [f32; 4],
    den: [f32; 4],
    valid: [bool; 4],
}

impl ScalarKernel {
    /// Moeller and Trumbore's test with the normal `e2 x e1`, edges included, both faces.
    #[inline(always)]
    fn cross(&self, block: &TriangleBlock, tfar: f32) -> Crossing {
        let mut out = Crossing { t: [0.0; 4], u: [0.0; 4], v: [0.0; 4], den: [0.0; 4], valid: [false; 4] };
        for lane in 0..4 {
            let at = |v: &[[f32; 4]; 3]| [v[0][lane], v[1][lane], v[2][lane]];
            let (v0, e1, e2) = (at(&block.v0), at(&block.e1), at(&block.e2));
            let c = [v0[0] - self.org[0], v0[1] - self.org[1], v0[2] - self.org[2]];
            let r = cross(c, self.dir);
            let normal = cross(e2, e1);
            let den = dot(normal, self.dir);
            let sign = 1f32.copysign(den);
            let (u, v, t) = (dot(r, e2) * sign, dot(r, e1) * sign, dot(normal, c) * sign);
            let den = den.abs();
            out.valid[lane] = (den != 0.0)
                & (u >= 0.0)
                & (v >= 0.0)
                & (u + v <= den)
                & (den * self.tnear < t)
                & (t <= den * tfar);
            (out.t[lane], out.u[lane], out.v[lane], out.den[lane]) = (t, u, v, den);
        }
        out
    }
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + (a[1] * b[1] + a[2] * b[2])
}

/// `a` if it is greater, else `b`: one instruction, unlike `f32::max`.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `a` if it is smaller, else `b`.
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
