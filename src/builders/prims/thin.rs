//! Thin triangles, among which the needles are: found in the pass that finds the bounds of all, four triangles at a
//! time.

use crate::builders::prims::refs::PrimInfo;
use crate::bvh::transposed;
use crate::geometry::{Aabb, Mesh};
use glam::{Vec3A, Vec4};

/// Which triangles are thin.
#[derive(Clone, Copy)]
pub(crate) struct Thin {
    /// Their boxes are larger than this (half area).
    pub min_area: f32,
    /// Their projections on the coordinate planes cover at most this share of half their box's area.
    pub filled: f32,
}

/// The x, the y and the z of four vectors.
type Four = [Vec4; 3];

impl Thin {
    /// Appends to `found` all thin triangles in a row, the first of which is `first`, and few others; returns the
    /// bounds of the row.
    pub fn find(self, mesh: &Mesh, first: u32, triangles: &[[u32; 3]], found: &mut Vec<u32>) -> PrimInfo {
        let (mut bounds, mut centers) = (FourBoxes::EMPTY, FourBoxes::EMPTY);
        let (fours, rest) = triangles.as_chunks();
        let last = rest.last().map(|last| std::array::from_fn(|i| *rest.get(i).unwrap_or(last)));
        let end = first + triangles.len() as u32;
        for (prim, [p, q, r, s]) in (first..).step_by(4).zip(fours.iter().chain(&last)) {
            let [p, q, r, s] =
                [mesh.corners_of(p), mesh.corners_of(q), mesh.corners_of(r), mesh.corners_of(s)];
            let corners = [
                transposed([p[0], q[0], r[0], s[0]]),
                transposed([p[1], q[1], r[1], s[1]]),
                transposed([p[2], q[2], r[2], s[2]]),
            ];
            let boxes = FourBoxes::of(&corners);
            bounds = bounds.union(&boxes);
            let doubled = along(|axis| boxes.min[axis] + boxes.max[axis]);
            centers = centers.union(&FourBoxes { min: doubled, max: doubled });
            // Branches are seldom taken: few triangles are thin, and of them few are large.
            let mut thin = self.among(&corners, &boxes) & ((1 << (end - prim).min(4)) - 1);
            while thin != 0 {
                found.push(prim + thin.trailing_zeros());
                thin &= thin - 1;
            }
        }
        PrimInfo { bounds: bounds.joined(), centers: centers.joined() }
    }

    /// Which of four triangles are thin, as bits.
    #[inline(always)]
    fn among(self, [a, b, c]: &[Four; 3], boxes: &FourBoxes) -> u32 {
        let [ux, uy, uz] = along(|axis| b[axis] - a[axis]);
        let [vx, vy, vz] = along(|axis| c[axis] - a[axis]);
        let doubled = (uy * vz - uz * vy).abs() + (uz * vx - ux * vz).abs() + (ux * vy - uy * vx).abs();
        let [x, y, z] = along(|axis| boxes.max[axis] - boxes.min[axis]);
        let area = x * (y + z) + y * z;
        // The share is a little larger than asked for: elsewhere sums are rounded otherwise.
        let is_thin = doubled.cmple(area * (2.001 * self.filled)) & area.cmpgt(Vec4::splat(self.min_area));
        is_thin.bitmask()
    }
}

/// Of each axis.
#[inline(always)]
fn along(of_axis: impl Fn(usize) -> Vec4) -> Four {
    [of_axis(0), of_axis(1), of_axis(2)]
}

/// Four boxes.
struct FourBoxes {
    min: Four,
    max: Four,
}

impl FourBoxes {
    const EMPTY: Self = Self { min: [Vec4::INFINITY; 3], max: [Vec4::NEG_INFINITY; 3] };

    #[inline(always)]
    fn of([a, b, c]: &[Four; 3]) -> Self {
        Self {
            min: along(|axis| a[axis].min(b[axis]).min(c[axis])),
            max: along(|axis| a[axis].max(b[axis]).max(c[axis])),
        }
    }

    #[inline(always)]
    fn union(&self, other: &Self) -> Self {
        Self {
            min: along(|axis| self.min[axis].min(other.min[axis])),
            max: along(|axis| self.max[axis].max(other.max[axis])),
        }
    }

    /// The box of all four.
    fn joined(&self) -> Aabb {
        let corner = |of_axis: [f32; 3]| Vec3A::from_array(of_axis);
        Aabb { min: corner(self.min.map(Vec4::min_element)), max: corner(self.max.map(Vec4::max_element)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::prims::needle::Needle;
    use crate::builders::testing::mesh;
    use glam::Vec3;

    #[test]
    fn every_needle_is_found_and_hardly_another_triangle() {
        for (n, scale) in [(1, 1.0), (2, 1.0), (3, 1.0), (4, 1e9), (1001, 1e-3), (1003, 5e17), (1002, 1e-15)]
        {
            let mesh = mesh(n, 7, |i, random| {
                let [a, b] = [random.point(0.0, scale), random.point(0.0, scale)];
                let width = scale * [0.0, 1e-4, 1e-2, 1.0][i % 4];
                [a, b, a + width * Vec3::new(1.0, 0.5, 0.0)]
            });
            for (min_area, filled) in [(0.1 * scale * scale, 0.15), (0.0, 0.5), (0.0, 0.0)] {
                let mut found = Vec::new();
                let info = Thin { min_area, filled }.find(&mesh, 0, mesh.triangles(), &mut found);
                assert_eq!(info, PrimInfo::of(&mesh, 0..n as u32));
                let needles = |filled: f32| {
                    let is_needle =
                        |prim: &u32| Needle::of(mesh.corners(*prim), *prim, min_area, filled).is_some();
                    (0..n as u32).filter(is_needle).collect::<Vec<u32>>()
                };
                assert!(found.is_sorted() && needles(filled).iter().all(|prim| found.contains(prim)));
                // A thousandth above the share, and those without any area at all.
                let most = needles(1.002 * filled + 1e-6).len();
                assert!(found.len() <= most, "{n} of size {scale}: {} found, {most} needles", found.len());
            }
        }
    }
}
