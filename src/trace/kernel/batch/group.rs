//! A group of rays: packets, one lane per ray, and bounds that hold for all of them.

use crate::bvh::WideNode;
use crate::geometry::{Hit, Ray};
use crate::trace::kernel::scalar::SMALLEST_DIRECTION;

/// Most rays of a group: a mask has a bit for each.
pub(super) const SIZE: usize = 64;

/// Sixteen rays, or eight in the first half where vectors have eight lanes.
#[derive(Clone)]
#[repr(C, align(64))]
pub(super) struct Packet {
    pub(super) rdir: [[f32; 16]; 3],
    pub(super) org_rdir: [[f32; 16]; 3],
    pub(super) tnear: [f32; 16],
    /// Distance of the closest hit so far, or the end of the interval.
    pub(super) t: [f32; 16],
    pub(super) org: [[f32; 16]; 3],
    pub(super) dir: [[f32; 16]; 3],
    pub(super) u: [f32; 16],
    pub(super) v: [f32; 16],
    pub(super) prim: [u32; 16],
}

impl Packet {
    /// Without rays: lanes whose interval is empty.
    pub(super) const EMPTY: Self = Self {
        rdir: [[1.0; 16]; 3],
        org_rdir: [[0.0; 16]; 3],
        tnear: [0.0; 16],
        t: [-1.0; 16],
        org: [[0.0; 16]; 3],
        dir: [[1.0; 16]; 3],
        u: [0.0; 16],
        v: [0.0; 16],
        prim: [Hit::NONE; 16],
    };

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, ray: &Ray, rdir: [f32; 3]) {
        let (org, dir) = (ray.org.to_array(), ray.dir.to_array());
        for axis in 0..3 {
            self.rdir[axis][lane] = rdir[axis];
            self.org_rdir[axis][lane] = org[axis] * rdir[axis];
            self.org[axis][lane] = org[axis];
            self.dir[axis][lane] = dir[axis];
        }
        self.tnear[lane] = ray.tnear;
        self.t[lane] = ray.tfar;
        self.prim[lane] = Hit::NONE;
    }

    /// The ray of `lane`, as far as its closest hit so far.
    #[inline(always)]
    pub(super) fn ray(&self, lane: usize) -> Ray {
        let at = |v: &[[f32; 16]; 3]| [v[0][lane], v[1][lane], v[2][lane]].into();
        Ray { org: at(&self.org), tnear: self.tnear[lane], dir: at(&self.dir), tfar: self.t[lane] }
    }

    #[inline(always)]
    pub(super) fn hit(&self, lane: usize) -> Hit {
        match self.prim[lane] {
            Hit::NONE => Hit::MISS,
            prim => Hit { t: self.t[lane], u: self.u[lane], v: self.v[lane], prim },
        }
    }

    #[inline(always)]
    pub(super) fn set_hit(&mut self, lane: usize, hit: &Hit) {
        self.t[lane] = hit.t;
        self.u[lane] = hit.u;
        self.v[lane] = hit.v;
        self.prim[lane] = hit.prim;
    }
}

/// Intervals that hold the origins and the reciprocal directions of all rays of a group, whose directions have the same
/// signs. A box that no ray of such intervals meets is met by none of the group (Reshetov et al., "Multi-Level Ray
/// Tracing Algorithm", 2005).
pub(super) struct Bounds {
    org: [[f32; 3]; 2],
    rdir: [[f32; 3]; 2],
    tnear: f32,
    /// Greatest distance at which a ray of the group may still find a closer hit.
    pub(super) t: f32,
}

/// As in the portable kernel: the products are rounded, so what is left is widened.
const WIDEN: f32 = 1.0 + 4.0 * f32::EPSILON;

impl Bounds {
    pub(super) const EMPTY: Self = Self {
        org: [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]],
        rdir: [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]],
        tnear: f32::INFINITY,
        t: f32::NEG_INFINITY,
    };

    /// Takes a ray in; returns its reciprocal direction.
    #[inline(always)]
    pub(super) fn add(&mut self, ray: &Ray) -> [f32; 3] {
        let org = ray.org.to_array();
        let safe = |x: f32| {
            let least = if x < 0.0 { -SMALLEST_DIRECTION } else { SMALLEST_DIRECTION };
            if x.abs() < SMALLEST_DIRECTION { least } else { x }
        };
        let rdir = ray.dir.to_array().map(|x| 1.0 / safe(x));
        for axis in 0..3 {
            self.org[0][axis] = lesser(org[axis], self.org[0][axis]);
            self.org[1][axis] = greater(org[axis], self.org[1][axis]);
            self.rdir[0][axis] = lesser(rdir[axis], self.rdir[0][axis]);
            self.rdir[1][axis] = greater(rdir[axis], self.rdir[1][axis]);
        }
        self.tnear = lesser(ray.tnear, self.tnear);
        self.t = greater(ray.tfar, self.t);
        rdir
    }

    /// Whether directions point up along `axis`.
    #[inline(always)]
    pub(super) fn is_positive(&self, axis: usize) -> bool {
        self.rdir[0][axis] >= 0.0
    }

    /// The children that some ray of such intervals may meet, as a bit mask, and where it enters them at the earliest.
    #[inline(always)]
    pub(super) fn enter<const N: usize>(&self, node: &WideNode<N>) -> (u32, [f32; N]) {
        let (mut enter, mut leave) = ([self.tnear; N], [self.t; N]);
        for axis in 0..3 {
            let up = self.is_positive(axis);
            let (near, far) = if up { (&node.lower, &node.upper) } else { (&node.upper, &node.lower) };
            let (before, behind) = (self.org[usize::from(up)][axis], self.org[usize::from(!up)][axis]);
            let [low, high] = [self.rdir[0][axis], self.rdir[1][axis]];
            for slot in 0..N {
                let gap = near[axis][slot] - before;
                enter[slot] = greater(lesser(gap * low, gap * high), enter[slot]);
                let gap = far[axis][slot] - behind;
                leave[slot] = lesser(greater(gap * low, gap * high) * WIDEN, leave[slot]);
            }
        }
        let mut mask = 0;
        for slot in 0..N {
            mask |= u32::from(enter[slot] <= leave[slot]) << slot;
        }
        (mask, enter)
    }
}

/// `a` if it is greater, else `b`: one instruction, unlike `f32::max`.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `a` if it is less, else `b`.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
