//! Needles, thin diagonal triangles, and the pieces that [`crate::builders::prims::presplit`] makes of them.

use crate::builders::prims::refs::Fragment;
use crate::geometry::Aabb;
use crate::geometry::triangle_split::split_triangle;
use crate::memory::huge_pages;
use glam::Vec3A;

/// Most times a triangle is halved.
const MAX_LEVELS: u32 = 12;

/// A triangle to be split.
pub(crate) struct Needle {
    /// The triangle.
    pub prim: u32,
    /// Sum of its projections' areas.
    projected: f32,
    /// Halvings until its pieces are small or no needles.
    levels: u32,
}

impl Needle {
    /// The triangle as a needle, if its box is larger than `min_area` (half area) and its projections cover less
    /// than the share `filled` of it.
    #[inline]
    pub fn of(corners: [Vec3A; 3], prim: u32, min_area: f32, filled: f32) -> Option<Self> {
        let area = Aabb::of_triangle(corners).half_area();
        let projected = projected_area(corners);
        // One branch: needles are rare, but which boxes are large cannot be foreseen.
        ((area > min_area) & (projected < filled * area)).then(|| {
            // A halving quarters the area of the box, and so doubles the share that is filled.
            let until_small = ceil_log2(area / min_area).div_ceil(2);
            let until_filled = ceil_log2(filled * area / projected);
            Self { prim, projected, levels: until_small.min(until_filled).clamp(1, MAX_LEVELS) }
        })
    }

    /// Most pieces it is split into.
    pub fn most_pieces(&self) -> u64 {
        1 << self.levels
    }
}

/// The logarithm to base 2 of `x`, rounded up, from its bits: the same on any platform. `x` is at least 1; much of
/// infinity.
fn ceil_log2(x: f32) -> u32 {
    let bits = x.to_bits();
    let is_no_power = bits.trailing_zeros() < f32::MANTISSA_DIGITS - 1;
    (bits >> (f32::MANTISSA_DIGITS - 1)).saturating_sub(127) + u32::from(is_no_power)
}

/// The sum of the areas of a triangle's projections on the coordinate planes: each lies in a face of its box,
/// and the three faces' areas are half the box's.
fn projected_area(corners: [Vec3A; 3]) -> f32 {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).abs();
    0.5 * normal.element_sum()
}

/// Splits the needles of a scene.
pub(crate) struct Splitter {
    grid: Grid,
    min_area: f32,
    filled: f32,
}

impl Splitter {
    /// Of the scene with the box `scene`; thresholds as of [`Needle::of`].
    pub fn new(scene: Aabb, min_area: f32, filled: f32) -> Self {
        Self { grid: Grid::new(scene), min_area, filled }
    }

    /// Appends the pieces of a needle, in order along it.
    pub fn split(&self, corners: [Vec3A; 3], bounds: Aabb, needle: &Needle, pieces: &mut Vec<Fragment>) {
        let mut stack = arrayvec::ArrayVec::<_, { MAX_LEVELS as usize + 2 }>::new();
        stack.push((bounds, 0));
        while let Some((bounds, level)) = stack.pop() {
            let area = bounds.half_area();
            // A piece halved `level` times is about as much shorter.
            let projected = needle.projected / (1 << level) as f32;
            let is_needle = level < needle.levels && area > self.min_area && projected < self.filled * area;
            if is_needle && let Some((axis, plane)) = self.grid.central_plane(bounds) {
                let halves = split_triangle(&corners, bounds, axis, plane);
                if halves.iter().any(|half| !half.is_empty()) {
                    let [left, right] = halves;
                    stack.extend([right, left].into_iter().filter(|b| !b.is_empty()).map(|b| (b, level + 1)));
                    continue;
                }
            }
            huge_pages::push(pieces, Fragment { bounds, prim: needle.prim }, "pieces of needles");
        }
    }
}

/// Cells per axis of the grid whose planes split needles.
const CELLS: f32 = (1 << 16) as f32;

/// A grid over the scene. Needles that lie side by side are cut by the same planes, so that their pieces fit
/// into the same nodes.
struct Grid {
    origin: Vec3A,
    extent: Vec3A,
    /// Cells per unit.
    scale: Vec3A,
}

impl Grid {
    fn new(scene: Aabb) -> Self {
        let extent = scene.extent().max(Vec3A::ZERO);
        let scale =
            Vec3A::select(extent.cmpgt(Vec3A::splat(1e-30)), Vec3A::splat(CELLS) / extent, Vec3A::ZERO);
        Self { origin: scene.min, extent, scale }
    }

    /// The plane that halves the largest cells among those that cross the middle half of the longest edge of
    /// `bounds`, or its very middle where there is none: the two halves should be alike first, a piece be of few
    /// cells second.
    fn central_plane(&self, bounds: Aabb) -> Option<(usize, f32)> {
        let extent = bounds.extent();
        let axis = extent.max_position();
        let middle = bounds.center()[axis];
        let cell = |x: f32| ((x - self.origin[axis]) * self.scale[axis]).clamp(0.0, CELLS - 1.0) as u32;
        let (low, high) = (cell(middle - 0.25 * extent[axis]), cell(middle + 0.25 * extent[axis]));
        let plane = if low == high {
            middle
        } else {
            let bit = 31 - (low ^ high).leading_zeros();
            self.origin[axis] + self.extent[axis] * ((high >> bit << bit) as f32 / CELLS)
        };
        (bounds.min[axis] < plane && plane < bounds.max[axis]).then_some((axis, plane))
    }
}

#[cfg(test)]
mod tests {
    use super::ceil_log2;

    #[test]
    fn logarithms_are_rounded_up() {
        for exponent in 0..127 {
            let power = (1u128 << exponent) as f32;
            assert_eq!(ceil_log2(power), exponent);
            assert_eq!(ceil_log2(power.next_up()), exponent + 1);
            assert_eq!(ceil_log2((2.0 * power).next_down()), exponent + 1);
        }
        assert!(ceil_log2(f32::INFINITY) > 100);
    }
}
