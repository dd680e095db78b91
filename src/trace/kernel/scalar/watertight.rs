//! The watertight tests: padded boxes, sheared corners.

use super::boxes::boxes_met;
use super::crossing::Crossing;
use crate::bvh::WideNode;
use crate::geometry::{Aabb, Hit, Ray};
use crate::trace::kernel::corners::CornerBlock;
use crate::trace::kernel::frame::{self, Frame};
use crate::trace::kernel::traverse::{Entries, Kernel};

/// A prepared ray.
#[derive(Clone, Copy)]
pub(in crate::trace::kernel) struct WatertightScalar(Frame);

impl Kernel for WatertightScalar {
    /// The bounds of the mesh.
    type Setup = Aabb;
    type Block = CornerBlock;

    #[inline(always)]
    fn scaled(ray: &Ray) -> (Ray, f32) {
        frame::scaled(ray)
    }

    #[inline(always)]
    fn new(bounds: Aabb, ray: &Ray) -> Self {
        Self(Frame::new(ray, bounds))
    }

    #[inline(always)]
    fn enter<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>) {
        let frame = &self.0;
        let near = |axis: usize, plane: f32| plane * frame.rdir[axis] - frame.near_org_rdir[axis];
        let far = |axis: usize, plane: f32| plane * frame.rdir[axis] - frame.far_org_rdir[axis];
        boxes_met(node, frame.rdir, [frame.tnear, tfar], near, far)
    }

    #[inline(always)]
    fn closest(&self, block: &CornerBlock, hit: &mut Hit) {
        self.cross(block, hit.t).closest(&block.prims, hit);
    }

    #[inline(always)]
    fn any(&self, block: &CornerBlock, tfar: f32) -> bool {
        self.cross(block, tfar).valid.contains(&true)
    }

    #[inline(always)]
    fn prefetch(_: *const u8, _: usize) {}
}

impl WatertightScalar {
    #[inline(always)]
    fn cross(&self, block: &CornerBlock, tfar: f32) -> Crossing {
        let frame = &self.0;
        let mut out = Crossing::NONE;
        for lane in 0..4 {
            // Corners relative to the origin; x and y sheared so that the ray runs along z.
            let [a, b, c] = [0, 1, 2].map(|corner| {
                let [x, y, z] =
                    [0, 1, 2].map(|axis| block.corners[corner][frame.axes()[axis]][lane] - frame.org[axis]);
                [x - frame.shear[0] * z, y - frame.shear[1] * z, z]
            });
            let (u, v, w) = (edge(b, c), edge(c, a), edge(a, b));
            let sum = (u + v) + w;
            let sign = 1f32.copysign(sum);
            let (u, v, w, den) = (u * sign, v * sign, w * sign, sum.abs());
            if (u >= 0.0) & (v >= 0.0) & (w >= 0.0) & (den != 0.0) {
                let t = self.distance(block, lane, [a[2], b[2], c[2]]);
                out.valid[lane] = (frame.tnear < t) & (t <= tfar);
                (out.t[lane], out.u[lane], out.v[lane], out.den[lane]) = (t, v / den, w / den, 1.0);
            }
        }
        out
    }

    /// Of the plane of the triangle in `lane` along the ray, and never beside its corners, whose `z` are those
    /// relative to the origin: a plane that contains the ray up to rounding is hit, too.
    #[inline(always)]
    fn distance(&self, block: &CornerBlock, lane: usize, z: [f32; 3]) -> f32 {
        let Frame { org, shear, .. } = self.0;
        let at = |corner: usize, axis: usize| block.corners[corner][self.0.axes()[axis]][lane];
        let edge = |corner: usize| [0, 1, 2].map(|axis| at(corner, axis) - at(0, axis));
        let (p, q) = (edge(1), edge(2));
        let normal = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        let [x, y] = [0, 1].map(|axis| at(0, axis) - org[axis]);
        let height = normal[0] * x + (normal[1] * y + normal[2] * z[0]);
        let approach = normal[0] * shear[0] + (normal[1] * shear[1] + normal[2]);
        // `f32::max` and `min` return the bound where the quotient is none.
        let near = z[0].min(z[1]).min(z[2]);
        let far = z[0].max(z[1]).max(z[2]);
        (height / approach).max(near).min(far) * shear[2]
    }
}

/// Twice the area of the triangle of the origin and the projected edge from `p` to `q`, with the sign of the exact
/// value: where the rounded products are equal, their errors decide.
#[inline(always)]
fn edge(p: [f32; 3], q: [f32; 3]) -> f32 {
    let (left, right) = (q[0] * p[1], q[1] * p[0]);
    if left == right {
        // Products and their differences of `f32` are exact in `f64`.
        let wide = |a: f32, b: f32| f64::from(a) * f64::from(b);
        let error = |product: f64, rounded: f32| (product - f64::from(rounded)) as f32;
        error(wide(q[0], p[1]), left) - error(wide(q[1], p[0]), right)
    } else {
        left - right
    }
}
