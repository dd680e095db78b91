//! Presplitting (Karras & Aila 2013, section 4; suggested in the paper's 5.3): triangles whose boxes are mostly
//! empty are replaced by pieces of them before the Morton sort.
//!
//! Which triangles deserve it? Not all with a large box: a right triangle in a wall fills half of its box, its
//! neighbour fills the other half, and its pieces need leaves and nodes while no box above them shrinks.
//! Only *needles* do: of a thin diagonal triangle each half has a quarter of the box's area, so that k pieces
//! have a k-th in all. As a needle's piece gets shorter it fills more of its box, twice as much with each
//! halving, and stops being one. There is no budget to spend: a scene without needles is left as it is.

use super::reference_split::split_reference;
use super::references::{Fragment, GRAIN};
use crate::geometry::{Aabb, Mesh};
use glam::Vec3A;
use rayon::prelude::*;

/// Which triangles are presplit.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct PresplitConfig {
    /// A needle's projections on the coordinate planes sum up to at most this part of half its box's area (at
    /// most 0.5 for any triangle).
    pub filled: f32,
    /// Boxes of at most this part of the scene's area are not split.
    pub min_area: f32,
    /// Most pieces per triangle of the scene, beyond the first of each. Where it would be exceeded the scene is of
    /// needles throughout, as hair is: their pieces overlap as the needles do, and none is split.
    pub max_extra: f32,
}

impl PresplitConfig {
    /// The constants are where the cost stops falling on scenes of rods, pipes and rotated buildings.
    pub const NEEDLES: Self = Self { filled: 0.15, min_area: 1.0 / (1 << 15) as f32, max_extra: 0.25 };
}

/// Most times a triangle is halved.
const MAX_LEVELS: u32 = 12;

/// A triangle to be split.
struct Needle {
    prim: u32,
    /// Sum of its projections' areas.
    projected: f32,
    /// Halvings until its pieces are small or no needles.
    levels: u32,
}

/// The pieces of all needles of `mesh`, whose box is `scene`: in the order of the triangles, those of each in a row.
pub(super) fn presplit(mesh: &Mesh, scene: Aabb, config: &PresplitConfig) -> Vec<Fragment> {
    let min_area = scene.half_area() * config.min_area;
    let needles: Vec<Vec<Needle>> = mesh
        .triangles()
        .par_chunks(GRAIN)
        .enumerate()
        .map(|(chunk, triangles)| {
            let numbered = (chunk as u32 * GRAIN as u32..).zip(triangles);
            numbered
                .filter_map(|(prim, triangle)| needle(mesh.corners_of(triangle), prim, min_area, config))
                .collect()
        })
        .collect();
    let extra: u64 = needles.iter().flatten().map(|needle| (1 << needle.levels) - 1).sum();
    if extra > (mesh.len() as f64 * f64::from(config.max_extra)) as u64 {
        return Vec::new();
    }
    let splitter = Splitter { grid: Grid::new(scene), min_area, filled: config.filled };
    let pieces: Vec<Vec<Fragment>> = needles
        .par_iter()
        .map(|needles| {
            let mut pieces = Vec::new();
            for needle in needles {
                let corners = mesh.corners(needle.prim);
                splitter.split(corners, Aabb::of_triangle(corners), needle, &mut pieces);
            }
            pieces
        })
        .collect();
    pieces.concat()
}

/// The triangle as a needle, if it is one with a box larger than `min_area`.
#[inline]
fn needle(corners: [Vec3A; 3], prim: u32, min_area: f32, config: &PresplitConfig) -> Option<Needle> {
    let area = Aabb::of_triangle(corners).half_area();
    if area <= min_area {
        return None;
    }
    let projected = projected_area(corners);
    (projected < config.filled * area).then(|| Needle {
        prim,
        projected,
        levels: halvings(((area / min_area).log2() * 0.5).min((config.filled * area / projected).log2())),
    })
}

fn halvings(levels: f32) -> u32 {
    (levels.ceil() as u32).clamp(1, MAX_LEVELS)
}

/// The sum of the areas of a triangle's projections on the coordinate planes: each lies in a face of its box,
/// and the three faces' areas are half the box's.
fn projected_area(corners: [Vec3A; 3]) -> f32 {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).abs();
    0.5 * normal.element_sum()
}

/// Splits needles.
struct Splitter {
    grid: Grid,
    min_area: f32,
    filled: f32,
}

impl Splitter {
    /// Appends the pieces of a needle, in order along it.
    fn split(&self, corners: [Vec3A; 3], bounds: Aabb, needle: &Needle, pieces: &mut Vec<Fragment>) {
        let mut stack = arrayvec::ArrayVec::<_, { MAX_LEVELS as usize + 2 }>::new();
        stack.push((bounds, 0));
        while let Some((bounds, level)) = stack.pop() {
            let area = bounds.half_area();
            // A piece halved `level` times is about as much shorter.
            let projected = needle.projected / (1 << level) as f32;
            let is_needle = level < needle.levels && area > self.min_area && projected < self.filled * area;
            if is_needle && let Some((axis, plane)) = self.grid.central_plane(bounds) {
                let halves = split_reference(&corners, bounds, axis, plane);
                if halves.iter().any(|half| !half.is_empty()) {
                    let [left, right] = halves;
                    stack.extend([right, left].into_iter().filter(|b| !b.is_empty()).map(|b| (b, level + 1)));
                    continue;
                }
            }
            pieces.push(Fragment { bounds, prim: needle.prim });
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
    use super::*;

    fn soup(triangles: &[[[f32; 3]; 3]]) -> Mesh {
        let ids = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Mesh::new(triangles.concat(), ids).unwrap().0
    }

    fn presplit_all(mesh: &Mesh, config: &PresplitConfig) -> Vec<Fragment> {
        presplit(mesh, mesh.bounds(), config)
    }

    /// Diagonal needles, some of no area at all, all through one box.
    fn needles(n: usize, scale: f32) -> Mesh {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32 * scale
        };
        let mut point = || [random(), random(), random()];
        let needle = |i: usize, a: [f32; 3], b| [a, b, [a[0] + scale * 1e-3 * (i % 3) as f32, a[1], a[2]]];
        soup(&(0..n).map(|i| needle(i, point(), point())).collect::<Vec<_>>())
    }

    const NO_BOUND: PresplitConfig = PresplitConfig { max_extra: 1e6, ..PresplitConfig::NEEDLES };

    #[test]
    fn needles_are_split_and_other_triangles_are_not() {
        let wall = [[0., 0., 0.], [9., 0., 0.], [0., 9., 0.]];
        let slope = [[0., 0., 0.], [9., 0., 0.], [9., 9., 9.]];
        let along_an_axis = [[0., 0., 0.], [9., 0., 0.], [0., 0.1, 0.]];
        let needle = [[0., 0., 0.], [9., 9., 9.], [0., 0.1, 0.]];
        let pieces = presplit_all(&soup(&[wall, slope, along_an_axis, needle]), &NO_BOUND);
        assert!(pieces.len() > 8 && pieces.iter().all(|piece| piece.prim == 3), "{}", pieces.len());
        let area: f32 = pieces.iter().map(|piece| piece.bounds.half_area()).sum();
        assert!(area < 243.0 / 8.0, "{area}");
    }

    #[test]
    fn pieces_cover_their_triangle_and_lie_in_its_box() {
        for scale in [1.0, 1e18, 1e-15, 1e-40] {
            let mesh = needles(200, scale);
            let pieces = presplit_all(&mesh, &NO_BOUND);
            assert!(pieces.len() > 1000 || scale < 1e-20, "{scale}: {}", pieces.len());
            for of_one in pieces.chunk_by(|a, b| a.prim == b.prim) {
                let prim = of_one[0].prim;
                let whole = mesh.bounds_of(prim);
                assert!(of_one.iter().all(|p| !p.bounds.is_empty() && whole.contains(p.bounds)));
                let [a, b, c] = mesh.corners(prim).map(|v| v.as_dvec3());
                for (i, j) in (0..=40).flat_map(|i| (0..=40 - i).map(move |j| (i, j))) {
                    let point = a + (b - a) * (f64::from(i) / 40.0) + (c - a) * (f64::from(j) / 40.0);
                    // The point is rounded to double precision.
                    let slack = f64::from(scale) * 1e-15;
                    assert!(
                        of_one.iter().any(|p| point.cmpge(p.bounds.min.as_dvec3() - slack).all()
                            && point.cmple(p.bounds.max.as_dvec3() + slack).all()),
                        "{scale}: triangle {prim} at {i}, {j}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_scene_of_needles_throughout_is_left_as_it_is() {
        let mesh = needles(5000, 100.0);
        let all = presplit_all(&mesh, &NO_BOUND).len();
        let extra = (all - 5000) as f32 / 5000.0;
        for (max_extra, expected) in [(0.0, 0), (0.5, 0), (0.99 * extra, 0), (1.01 * extra + 1.0, all)] {
            let pieces = presplit_all(&mesh, &PresplitConfig { max_extra, ..PresplitConfig::NEEDLES });
            assert!(pieces.len() == expected || max_extra > extra, "{max_extra}: {}", pieces.len());
        }
    }

    #[test]
    fn pieces_are_the_same_at_any_number_of_threads() {
        let mesh = needles(30_000, 1.0);
        let at = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let pieces = pool.install(|| presplit_all(&mesh, &NO_BOUND));
            pieces.into_iter().map(|piece| (piece.prim, piece.bounds)).collect::<Vec<_>>()
        };
        let alone = at(1);
        assert!(at(3) == alone && at(8) == alone);
    }
}
