//! Four intersections at once, and the closest of them.

use crate::geometry::Hit;
use crate::geometry::ordered::smaller;

/// Four intersections before the division by `den`.
pub(super) struct Crossing {
    pub t: [f32; 4],
    pub u: [f32; 4],
    pub v: [f32; 4],
    pub den: [f32; 4],
    pub valid: [bool; 4],
}

impl Crossing {
    pub(super) const NONE: Self =
        Self { t: [0.0; 4], u: [0.0; 4], v: [0.0; 4], den: [0.0; 4], valid: [false; 4] };

    /// Replaces `hit` by the closest of the valid lanes, if there is one; `prims` are their triangles. A lane whose
    /// distance is no positive number stands back: the products of the test left the range of `f32`, and what lies
    /// behind must not be hidden.
    #[inline(always)]
    pub(super) fn closest(&self, prims: &[u32; 4], hit: &mut Hit) {
        let mut is_first = true;
        for (lane, &prim) in prims.iter().enumerate() {
            if self.valid[lane] {
                let t = self.t[lane] / self.den[lane];
                let is_measured = (t > 0.0) & (t < f32::INFINITY);
                if is_measured && (is_first || hit.t > t) {
                    is_first = false;
                    *hit = Hit {
                        t,
                        u: smaller(self.u[lane] / self.den[lane], 1.0),
                        v: smaller(self.v[lane] / self.den[lane], 1.0),
                        prim,
                    };
                }
            }
        }
    }
}
