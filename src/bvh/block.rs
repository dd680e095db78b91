//! Leaf blocks: four triangles, ready for intersection.

use crate::geometry::Mesh;
use glam::{Mat4, Vec3A, Vec4};

/// The x, the y and the z of four points.
#[inline(always)]
pub(crate) fn transposed([a, b, c, d]: [Vec3A; 4]) -> [Vec4; 3] {
    // Not by `map`, which is not always inlined.
    let rows = Mat4::from_cols(a.extend(0.0), b.extend(0.0), c.extend(0.0), d.extend(0.0)).transpose();
    [rows.x_axis, rows.y_axis, rows.z_axis]
}

/// The first `count` of `prims`, then `u32::MAX`: without a branch, which could not be predicted.
#[inline(always)]
pub(super) fn first_of(count: usize, prims: [u32; 4]) -> [u32; 4] {
    std::array::from_fn(|lane| prims[lane] | u32::from(lane >= count).wrapping_neg())
}

/// Four triangles in structure-of-arrays form, ready for intersection: first corner and two edges.
/// Unused lanes hold zeros (never hit) and id [`crate::geometry::Hit::NONE`]; used lanes come first.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct TriangleBlock {
    /// First corner, `v0[axis][lane]`.
    pub v0: [[f32; 4]; 3],
    /// First corner minus second.
    pub e1: [[f32; 4]; 3],
    /// Third corner minus first.
    pub e2: [[f32; 4]; 3],
    /// Triangle ids.
    pub prims: [u32; 4],
}

impl TriangleBlock {
    /// A block without triangles.
    pub const EMPTY: Self =
        Self { v0: [[0.0; 4]; 3], e1: [[0.0; 4]; 3], e2: [[0.0; 4]; 3], prims: [u32::MAX; 4] };

    /// A block of the first `count` triangles, one to four, of `prims`.
    ///
    /// # Panics
    /// If one of all four is no triangle of `mesh`.
    #[inline(always)]
    pub fn of_first(count: usize, prims: [u32; 4], mesh: &Mesh) -> Self {
        // Corners are fetched for all lanes: a branch on their number could not be foreseen.
        let [p, q, r, s] = prims;
        let corners = [mesh.corners(p), mesh.corners(q), mesh.corners(r), mesh.corners(s)];
        Self::of_corners(count, prims, corners)
    }

    /// A block of the first `count` triangles, one to four, of `prims`, whose corners are given.
    #[inline(always)]
    pub fn of_corners(count: usize, prims: [u32; 4], [p, q, r, s]: [[Vec3A; 3]; 4]) -> Self {
        let a = transposed([p[0], q[0], r[0], s[0]]);
        let b = transposed([p[1], q[1], r[1], s[1]]);
        let c = transposed([p[2], q[2], r[2], s[2]]);
        let used = Vec4::new(0.0, 1.0, 2.0, 3.0).cmplt(Vec4::splat(count as u8 as f32));
        let lanes = |v: Vec4| Vec4::select(used, v, Vec4::ZERO).to_array();
        Self {
            v0: [lanes(a[0]), lanes(a[1]), lanes(a[2])],
            e1: [lanes(a[0] - b[0]), lanes(a[1] - b[1]), lanes(a[2] - b[2])],
            e2: [lanes(c[0] - a[0]), lanes(c[1] - a[1]), lanes(c[2] - a[2])],
            prims: first_of(count, prims),
        }
    }

    /// Fills `lane`.
    ///
    /// # Panics
    /// If that is 4 or more.
    #[inline]
    pub fn set(&mut self, lane: usize, corners: [Vec3A; 3], prim: u32) {
        let e1 = corners[0] - corners[1];
        let e2 = corners[2] - corners[0];
        for axis in 0..3 {
            self.v0[axis][lane] = corners[0][axis];
            self.e1[axis][lane] = e1[axis];
            self.e2[axis][lane] = e2[axis];
        }
        self.prims[lane] = prim;
    }

    /// The block without triangle `prim`, whose lanes are left empty: behind them there may be others, which kernels
    /// allow.
    #[inline]
    pub(crate) fn without(&self, prim: u32) -> Self {
        let mut rest = *self;
        for lane in 0..4 {
            if self.prims[lane] == prim {
                rest.set(lane, [Vec3A::ZERO; 3], u32::MAX);
            }
        }
        rest
    }

    /// Whether its data are those of triangles of `mesh`, of one at least, in lanes without gaps.
    pub(crate) fn is_of(&self, mesh: &Mesh) -> bool {
        let mut expected = Self::EMPTY;
        for (lane, prim) in self.ids().enumerate() {
            if prim as usize >= mesh.len() {
                return false;
            }
            expected.set(lane, mesh.corners(prim), prim);
        }
        // Comparison finds gaps between lanes too.
        expected.prims[0] != u32::MAX && *self == expected
    }

    /// The ids in use.
    #[inline]
    pub fn ids(&self) -> impl Iterator<Item = u32> + '_ {
        self.prims.iter().copied().filter(|&prim| prim != u32::MAX)
    }
}
