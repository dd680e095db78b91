//! The fast tests. The box test is conservative: its far distances are widened by more than the rounding errors of the
//! products (Ize, "Robust BVH Ray Traversal", JCGT 2013). Triangles are tested by Moeller and Trumbore's method.

use super::boxes::boxes_met;
use super::crossing::Crossing;
use crate::bvh::{TriangleBlock, WideNode};
use crate::geometry::ordered::greater;
use crate::geometry::{Hit, Ray};
use crate::trace::kernel::traverse::{Entries, Kernel};

/// Components below this are taken for it, so that their reciprocals are finite and no slab yields NaN.
pub(in crate::trace::kernel) const SMALLEST_DIRECTION: f32 = 1e-18;

/// 1 + 4 ulp: twice Ize's bound, for the rounded reciprocal and the rounded factor.
const WIDEN: f32 = 1.0 + 4.0 * f32::EPSILON;

/// A prepared ray.
#[derive(Clone, Copy)]
pub(in crate::trace::kernel) struct FastScalar {
    org: [f32; 3],
    dir: [f32; 3],
    rdir: [f32; 3],
    tnear: f32,
}

impl Kernel for FastScalar {
    type Setup = ();
    type Block = TriangleBlock;

    #[inline(always)]
    fn new((): (), ray: &Ray) -> Self {
        let dir = ray.dir.to_array();
        let rdir = dir.map(|x| 1.0 / if x.abs() < SMALLEST_DIRECTION { SMALLEST_DIRECTION } else { x });
        Self { org: ray.org.to_array(), dir, rdir, tnear: greater(ray.tnear, 0.0) }
    }

    #[inline(always)]
    fn enter<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>) {
        let near = |axis: usize, plane: f32| (plane - self.org[axis]) * self.rdir[axis];
        let far = |axis: usize, plane: f32| near(axis, plane) * WIDEN;
        boxes_met(node, self.rdir, [self.tnear, tfar], near, far)
    }

    #[inline(always)]
    fn closest(&self, block: &TriangleBlock, hit: &mut Hit) {
        self.cross(block, hit.t).closest(&block.prims, hit);
    }

    #[inline(always)]
    fn any(&self, block: &TriangleBlock, tfar: f32) -> bool {
        self.cross(block, tfar).valid.contains(&true)
    }

    #[inline(always)]
    fn prefetch(_: *const u8, _: usize) {}
}

impl FastScalar {
    /// Moeller and Trumbore's test with the normal `e2 x e1`, edges included, both faces.
    #[inline(always)]
    fn cross(&self, block: &TriangleBlock, tfar: f32) -> Crossing {
        let mut out = Crossing::NONE;
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
