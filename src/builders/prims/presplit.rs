//! Presplitting (Karras & Aila 2013, section 4; suggested in the paper's 5.3): triangles whose boxes are mostly
//! empty are replaced by pieces of them before the Morton sort.
//!
//! Which triangles? Not all with a large box: a right triangle in a wall fills half of its box, its neighbour the
//! other half, and its pieces need leaves and nodes while no box above them shrinks. Only *needles*, thin diagonal
//! triangles: halving a needle quarters the box area of each half, so that k pieces total 1/k. Each halving doubles
//! how much of its box a piece fills, until it is no needle. No number of pieces is aimed at: a scene without
//! needles is left as it is.

use crate::builders::prims::needle::{Needle, Splitter};
use crate::builders::prims::refs::{Fragment, GRAIN, PrimInfo};
use crate::builders::prims::thin::Thin;
use crate::geometry::{Aabb, Mesh};
use crate::memory::huge_pages;
use crate::memory::pool::Pool;
use crate::parallel;
use crate::parallel::ordered_append::{self, Chunk, Offset};
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;

/// Triangles of the sample that tells which boxes are too small to be split.
const SAMPLE: usize = 256;

/// Which triangles are presplit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

/// Presplit triangles; memory is reused from build to build.
#[derive(Default)]
pub(crate) struct Presplit {
    /// The pieces of all needles: in the order of the triangles, those of each in a row.
    pub fragments: Vec<Fragment>,
    /// By [`GRAIN`] triangles; none where none is split.
    pub chunks: Vec<ChunkInfo>,
    /// Thin triangles, some too small to be split, likewise.
    thin: Vec<Vec<u32>>,
    pool: Pool<Pieces>,
}

/// The needles among [`GRAIN`] triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChunkInfo {
    /// The triangles that are split.
    pub needles: usize,
    /// Their pieces.
    pub pieces: usize,
    /// Bounds of the pieces.
    pub info: PrimInfo,
}

impl Presplit {
    /// Finds the thin triangles of `mesh`; returns the bounds of all. One pass does both, though which of the thin are
    /// large enough to be split is known after it: a sample of the scene tells of most that they are not.
    pub fn find(&mut self, mesh: &Mesh, config: &PresplitConfig) -> PrimInfo {
        let triangles = mesh.triangles();
        let sample = triangles.iter().step_by(triangles.len().div_ceil(SAMPLE).max(1));
        let bounds: Aabb = sample.map(|triangle| Aabb::of_triangle(mesh.corners_of(triangle))).collect();
        let thin = Thin { min_area: bounds.half_area() * config.min_area, filled: config.filled };
        let chunks = triangles.chunks(GRAIN).enumerate();
        let found = parallel::map(chunks, |(chunk, triangles)| {
            let mut found = Vec::new();
            (thin.find(mesh, (chunk * GRAIN) as u32, triangles, &mut found), found)
        });
        let (infos, thin): (Vec<_>, _) = found.into_iter().unzip();
        self.thin = thin;
        infos.into_iter().fold(PrimInfo::EMPTY, PrimInfo::union)
    }

    /// Splits the needles among the thin triangles of `mesh` that were found; its box is `scene`.
    pub fn split(&mut self, mesh: &Mesh, scene: Aabb, config: &PresplitConfig) {
        self.clear();
        let thin = std::mem::take(&mut self.thin);
        let min_area = scene.half_area() * config.min_area;
        let most_extra = (mesh.len() as f64 * f64::from(config.max_extra)) as u64;
        let extra = AtomicU64::new(0);
        let needles: Vec<Vec<Needle>> = parallel::map(thin, |thin| {
            let mut needles = Vec::new();
            // Too many already: none will be split.
            if extra.load(Relaxed) > most_extra {
                return needles;
            }
            for prim in thin {
                if let Some(needle) = Needle::of(mesh.corners(prim), prim, min_area, config.filled) {
                    huge_pages::push(&mut needles, needle, "needles");
                }
            }
            extra.fetch_add(needles.iter().map(|needle| needle.most_pieces() - 1).sum(), Relaxed);
            needles
        });
        let count = needles.iter().map(Vec::len).sum::<usize>();
        let extra = extra.into_inner();
        if count == 0 || extra > most_extra {
            return;
        }
        let splitter = Splitter::new(scene, min_area, config.filled);
        let Self { fragments, chunks, pool, .. } = self;
        huge_pages::reserve(fragments, count + extra as usize, "pieces of needles");
        huge_pages::reserve(chunks, needles.len(), "chunks of needles");
        ordered_append::append(needles.len(), pool, fragments, chunks, |i, pieces: &mut Pieces| {
            for needle in &needles[i] {
                let corners = mesh.corners(needle.prim);
                splitter.split(corners, Aabb::of_triangle(corners), needle, &mut pieces.fragments);
            }
            pieces.count(needles[i].len());
        });
    }

    /// Removes all pieces.
    pub fn clear(&mut self) {
        self.fragments.clear();
        self.chunks.clear();
    }
}

/// The pieces of a chunk's needles.
#[derive(Default)]
struct Pieces {
    fragments: Vec<Fragment>,
    chunk: Option<ChunkInfo>,
}

impl Pieces {
    /// Completes the chunk: its pieces are those of `needles` triangles.
    fn count(&mut self, needles: usize) {
        let info = self.fragments.iter().fold(PrimInfo::EMPTY, |all, fragment| all.grow(fragment.bounds));
        self.chunk = Some(ChunkInfo { needles, pieces: self.fragments.len(), info });
    }
}

impl Chunk for Pieces {
    type A = Fragment;
    type B = ChunkInfo;

    fn elements(&self) -> (&[Fragment], &[ChunkInfo]) {
        (&self.fragments, self.chunk.as_slice())
    }

    fn moved(fragment: &Fragment, _: Offset) -> Fragment {
        *fragment
    }

    fn clear(&mut self) {
        self.fragments.clear();
        self.chunk = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn soup(triangles: &[[[f32; 3]; 3]]) -> Mesh {
        let ids = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Mesh::new(triangles.concat(), ids).unwrap().0
    }

    fn presplit_all(mesh: &Mesh, config: &PresplitConfig) -> Vec<Fragment> {
        let mut presplit = Presplit::default();
        let info = presplit.find(mesh, config);
        assert_eq!(info, PrimInfo::of(mesh, 0..mesh.len() as u32));
        presplit.split(mesh, info.bounds, config);
        presplit.fragments
    }

    /// Diagonal needles, some of no area at all, all through one box.
    fn needles(n: usize, scale: f32) -> Mesh {
        let mut random = SplitMix64::new(1);
        let mut point = || (random.point(0.0, 1.0) * scale).to_array();
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
        // Several chunks: those that come late are not looked at.
        let mesh = needles(3 * GRAIN, 100.0);
        let all = presplit_all(&mesh, &NO_BOUND).len();
        let extra = (all - mesh.len()) as f32 / mesh.len() as f32;
        for (max_extra, expected) in [(0.0, 0), (0.5, 0), (0.99 * extra, 0), (4096.0, all)] {
            let pieces = presplit_all(&mesh, &PresplitConfig { max_extra, ..PresplitConfig::NEEDLES });
            assert_eq!(pieces.len(), expected, "{max_extra}");
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
