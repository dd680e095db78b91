//! The search: the nearest of the clusters up to a radius before and after each.
//!
//! Every distance is computed once, for both clusters: at each offset the distances of a tile of clusters to those
//! that far behind them are a row, from which both take the least. Rows are plain loops that the compiler turns
//! into vectors of whatever instruction set it compiles them for; none depends on the order of additions.

use crate::builders::binary::node::Node;
use crate::simd::Isa;

/// Clusters of a tile, whose rows fit the first cache.
const TILE: usize = 512;

/// The lowest bit of what stands for the neighbour `offset` after a position; that for the one before is the other.
/// The lesser is taken at equal distances. So at offset 1 the pair that begins at an even position wins, and clusters
/// that are all alike pair off; at larger offsets the later cluster wins. Some two clusters are always each other's
/// nearest: of the least distance and offset, the last in their row at that offset.
#[inline(always)]
fn side_after(position: u32, offset: u32) -> u32 {
    position & u32::from(offset == 1)
}

/// How far after the cluster at `position` its nearest is, or negative, where neighbours in order are merged.
pub(super) fn forced(position: usize) -> i16 {
    if position.is_multiple_of(2) { 1 } else { -1 }
}

/// Planes of the boxes of clusters in order, three lower and three upper ones, and memory of the search.
#[derive(Default)]
pub(super) struct BoxPlanes {
    planes: [Vec<f32>; 6],
    distances: Vec<u32>,
    best: Vec<u32>,
}

impl BoxPlanes {
    /// Those of `clusters`, from position `first` on, `len` of them; positions outside, negative ones too, have boxes
    /// that are far from everything.
    pub fn load(&mut self, clusters: &[Node], first: isize, len: usize) {
        let before = first.min(0).unsigned_abs().min(len);
        let begin = first.max(0) as usize;
        let inside = &clusters[begin.min(clusters.len())..(begin + len - before).min(clusters.len())];
        for (axis, plane) in self.planes.iter_mut().enumerate() {
            let far = if axis < 3 { f32::NEG_INFINITY } else { f32::INFINITY };
            plane.clear();
            plane.resize(before, far);
            if axis < 3 {
                plane.extend(inside.iter().map(|node| node.lower(axis)));
            } else {
                plane.extend(inside.iter().map(|node| node.upper(axis - 3)));
            }
            plane.resize(len, far);
        }
    }

    /// How far after each cluster its nearest is, negative if before; not of `radius` ones at either end of those
    /// loaded, the first of which is at an even position.
    pub fn search(&mut self, isa: Isa, radius: usize, nearest: &mut Vec<i16>) {
        nearest.resize(self.planes[0].len() - 2 * radius, 0);
        match isa {
            Isa::Scalar => self.search_all(radius, nearest),
            Isa::Avx2(token) => token.run(
                #[inline(always)]
                || self.search_all(radius, nearest),
            ),
            Isa::Avx512(token) => token.run(
                #[inline(always)]
                || self.search_all(radius, nearest),
            ),
        }
    }

    #[inline(always)]
    fn search_all(&mut self, radius: usize, nearest: &mut [i16]) {
        let Self { planes, distances, best } = self;
        // As many low bits of a distance give way as which neighbour takes.
        let low = (2 * radius).next_power_of_two() as u32 - 1;
        distances.resize(TILE + radius, 0);
        best.resize(TILE, 0);
        for (tile, nearest) in nearest.chunks_mut(TILE).enumerate() {
            let first = radius + tile * TILE;
            let best = &mut best[..nearest.len()];
            best.fill(u32::MAX);
            for offset in 1..=radius {
                let distances = &mut distances[..nearest.len() + offset];
                row(distances, planes, first - offset, offset, !low & !(1 << 31));
                let (before, after) = (&distances[..nearest.len()], &distances[offset..]);
                take(best, before, after, first as u32, offset as u32);
            }
            for (i, (nearest, best)) in nearest.iter_mut().zip(best).enumerate() {
                let which = *best & low;
                let offset = which / 2 + 1;
                let is_after = which & 1 == side_after((first + i) as u32, offset);
                *nearest = if is_after { offset as i16 } else { -(offset as i16) };
            }
        }
    }
}

/// Writes the bits that `mask` keeps of the distances of clusters, from position `first` on, to those `offset` after
/// them: areas are not negative, if zero may be, so that their bits are in their order.
#[inline(always)]
fn row(distances: &mut [u32], planes: &[Vec<f32>; 6], first: usize, offset: usize, mask: u32) {
    let len = distances.len();
    let plane = |plane: usize, first: usize| &planes[plane][first..][..len];
    let [a0, a1, a2] = [plane(0, first), plane(1, first), plane(2, first)];
    let [a3, a4, a5] = [plane(3, first), plane(4, first), plane(5, first)];
    let next = first + offset;
    let [b0, b1, b2] = [plane(0, next), plane(1, next), plane(2, next)];
    let [b3, b4, b5] = [plane(3, next), plane(4, next), plane(5, next)];
    let extent = |a: f32, b: f32, c: f32, d: f32| if c > d { c } else { d } - if a < b { a } else { b };
    for (i, distance) in distances.iter_mut().enumerate() {
        let x = extent(a0[i], b0[i], a3[i], b3[i]);
        let y = extent(a1[i], b1[i], a4[i], b4[i]);
        let z = extent(a2[i], b2[i], a5[i], b5[i]);
        // As `Aabb::half_area`.
        *distance = (x * (y + z) + y * z).to_bits() & mask;
    }
}

/// Takes the least of the best so far and the neighbours `before` and `after` at an offset; the first is of the
/// cluster at position `first`.
#[inline(always)]
fn take(best: &mut [u32], before: &[u32], after: &[u32], first: u32, offset: u32) {
    let which = 2 * (offset - 1);
    for (i, ((best, before), after)) in best.iter_mut().zip(before).zip(after).enumerate() {
        let side = side_after(first + i as u32, offset);
        *best = (*best).min(before | which | (side ^ 1)).min(after | which | side);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::testing::for_each_cut;
    use crate::geometry::Aabb;

    /// The nearest of each cluster, by comparing it with all within the radius.
    fn plain(clusters: &[Node], radius: usize) -> Vec<usize> {
        let low = (2 * radius).next_power_of_two() as u32 - 1;
        let area = |a: usize, b: usize| clusters[a].bounds().union(clusters[b].bounds()).half_area();
        let nearest = |i: usize| {
            let others = (i.saturating_sub(radius)..clusters.len().min(i + radius + 1)).filter(|&j| j != i);
            others.min_by_key(|&j| {
                let is_second = if i.abs_diff(j) == 1 { i.min(j) % 2 == 1 } else { j < i };
                (area(i, j).abs().to_bits() & !low, i.abs_diff(j), is_second)
            })
        };
        (0..clusters.len()).map(|i| nearest(i).unwrap()).collect()
    }

    #[test]
    fn the_nearest_are_found_with_any_instructions() {
        for_each_cut(|clusters, _| {
            for radius in [1, 2, 3, 25, 128] {
                let expected = plain(clusters, radius);
                for isa in Isa::available() {
                    let (mut boxes, mut nearest) = (BoxPlanes::default(), Vec::new());
                    boxes.load(clusters, -(radius as isize) * 2, clusters.len() + 4 * radius);
                    boxes.search(isa, radius, &mut nearest);
                    let found = &nearest[radius..][..clusters.len()];
                    let found: Vec<usize> =
                        (0..).zip(found).map(|(i, &near)| (i + isize::from(near)) as usize).collect();
                    assert_eq!(found, expected, "{isa}, {} clusters, radius {radius}", clusters.len());
                }
            }
        });
    }

    #[test]
    fn equal_clusters_pair_off() {
        let clusters = vec![Node::leaf(Aabb::new(glam::Vec3A::ZERO, glam::Vec3A::ONE), 0, 1); 6];
        assert_eq!(plain(&clusters, 4), [1, 0, 3, 2, 5, 4]);
        assert_eq!([0, 1, 6].map(forced), [1, -1, 1]);
    }
}
