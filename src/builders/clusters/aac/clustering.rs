//! The clustering: clusters of a run of Morton codes, merged from those of its halves.

use super::config::AacConfig;
use crate::builders::binary::node::Node;
use crate::builders::lbvh::key::{MortonKey, reference};
use crate::builders::lbvh::partition::partition;
use crate::builders::lbvh::prefetch;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::memory::huge_pages;
use crate::parallel;

/// Runs shorter than this are clustered by one thread, from triangles that fit its cache.
const SERIAL: usize = 1 << 12;

/// The root of the clusters of all `keys`, whose pairs go to `pairs`; `None` without keys.
pub(crate) fn cluster<G: Geometry>(
    config: &AacConfig,
    refs: &PrimRefs<'_, G>,
    keys: &mut [MortonKey],
    pairs: &mut Vec<[Node; 2]>,
) -> Option<Node> {
    huge_pages::resize(pairs, keys.len().saturating_sub(1), [Node::ZERO; 2], "pairs of clusters");
    let mut forest = Forest::default();
    if !keys.is_empty() {
        let of_few = std::array::from_fn(|n| config.clusters(n));
        AacClustering { config, of_few, refs: *refs }.build(keys, (0, 0), false, pairs, &mut forest);
        combine(&mut forest, 0, 1, 0, pairs);
    }
    forest.clusters.pop()
}

/// Clusters that wait to be merged, those of the current run last.
#[derive(Default)]
struct Forest {
    clusters: Vec<Node>,
    /// Places for pairs: always one less for a run than it has clusters.
    free: Vec<usize>,
    nearest: Vec<Neighbour>,
}

struct AacClustering<'a, G> {
    config: &'a AacConfig,
    /// Clusters left of few triangles: most runs are short, and powers are slow.
    of_few: [usize; 64],
    refs: PrimRefs<'a, G>,
}

impl<G: Geometry> AacClustering<'_, G> {
    /// Appends the clusters of a run of sorted keys that begins at `first`, whose pairs are `pairs`; `is_fetched` if
    /// its triangles are in the cache.
    fn build(
        &self,
        keys: &mut [MortonKey],
        (first, mut depth): (usize, u32),
        is_fetched: bool,
        pairs: &mut [[Node; 2]],
        forest: &mut Forest,
    ) {
        let (len, is_serial) = (keys.len(), keys.len() < SERIAL);
        let begin = (forest.clusters.len(), forest.free.len());
        if is_serial && !is_fetched {
            prefetch::primitives(self.refs.geometry, keys);
        }
        // One triangle cannot be partitioned, even where delta is 1.
        if len == 1 || len < self.config.delta {
            let bounds = |key: MortonKey| self.refs.bounds(reference(key));
            forest
                .clusters
                .extend(keys.iter().enumerate().map(|(i, &key)| Node::leaf(bounds(key), first + i, 1)));
            forest.free.extend(first..first + len - 1);
        } else {
            let split = partition(keys, &self.refs, &mut depth);
            let ([left, right], [left_pairs, right_pairs]) = halves(keys, pairs, split);
            let mut left =
                |forest: &mut Forest| self.build(left, (first, depth), is_serial, left_pairs, forest);
            let mut right = |forest: &mut Forest| {
                self.build(right, (first + split, depth), is_serial, right_pairs, forest)
            };
            if is_serial {
                left(forest);
                right(forest);
            } else {
                let mut other = Forest::default();
                parallel::join(|| left(forest), || right(&mut other));
                forest.clusters.append(&mut other.clusters);
                forest.free.append(&mut other.free);
            }
            forest.free.push(first + split - 1);
        }
        debug_assert_eq!(forest.clusters.len() - begin.0, forest.free.len() - begin.1 + 1);
        let target = self.of_few.get(len).copied().unwrap_or_else(|| self.config.clusters(len));
        combine(forest, begin.0, target, first, pairs);
    }
}

/// The two parts of a run, and of its pairs but for the one between them.
fn halves<'a>(
    keys: &'a mut [MortonKey],
    pairs: &'a mut [[Node; 2]],
    split: usize,
) -> ([&'a mut [MortonKey]; 2], [&'a mut [[Node; 2]]; 2]) {
    let (left, right) = keys.split_at_mut(split);
    let (left_pairs, right_pairs) = pairs.split_at_mut(split - 1);
    ([left, right], [left_pairs, &mut right_pairs[1..]])
}

/// Merges the clusters from position `begin` on, always the nearest two, until `target` are left. Distance is
/// the area of the common box.
fn combine(forest: &mut Forest, begin: usize, target: usize, first: usize, pairs: &mut [[Node; 2]]) {
    let Forest { clusters, free, nearest } = forest;
    let count = clusters.len() - begin;
    if count <= target {
        return;
    }
    find_all_nearest(&clusters[begin..], nearest);
    for last in (target..count).rev() {
        let i = closest(nearest);
        let j = nearest[i].index();
        let (a, b) = (i.min(j), i.max(j));
        let place = free.pop().expect("a run has a free pair less than clusters");
        let pair = [clusters[begin + a], clusters[begin + b]];
        pairs[place - first] = pair;
        clusters[begin + a] = Node::inner(&pair, place);
        // The last takes the place of b.
        clusters.swap_remove(begin + b);
        nearest.swap_remove(b);
        if last == target {
            break;
        }
        for (k, neighbour) in nearest.iter_mut().enumerate() {
            let near = neighbour.index();
            if k == a || near == a || near == b {
                *neighbour = find_nearest(&clusters[begin..], k);
            } else if near == last {
                *neighbour = neighbour.moved(b);
            }
        }
    }
}

/// A neighbour of a cluster: the area of their common box, then its index. The nearest is the least, and of equal
/// ones the first: no branch is needed to find it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Neighbour(u64);

impl Neighbour {
    const NONE: Self = Self(u64::MAX);

    #[inline(always)]
    fn new(area: f32, index: usize) -> Self {
        // Areas are not negative, if zero may be: their bits are in their order.
        Self(u64::from(area.abs().to_bits()) << 32 | index as u64)
    }

    #[inline(always)]
    fn index(self) -> usize {
        self.0 as u32 as usize
    }

    /// The same at another index.
    #[inline(always)]
    fn moved(self, index: usize) -> Self {
        Self(self.0 >> 32 << 32 | index as u64)
    }
}

/// The cluster whose nearest neighbour is nearest, the first of equal ones.
fn closest(nearest: &[Neighbour]) -> usize {
    let all = nearest.iter().enumerate().map(|(i, near)| near.moved(i));
    all.min().map_or(0, Neighbour::index)
}

/// The nearest neighbour of each cluster: every distance is measured once for both.
fn find_all_nearest(clusters: &[Node], nearest: &mut Vec<Neighbour>) {
    nearest.clear();
    for (i, cluster) in clusters.iter().enumerate() {
        let own = cluster.bounds();
        let mut best = Neighbour::NONE;
        for (j, (other, near)) in clusters.iter().zip(&mut *nearest).enumerate() {
            let area = own.union(other.bounds()).half_area();
            best = best.min(Neighbour::new(area, j));
            *near = (*near).min(Neighbour::new(area, i));
        }
        nearest.push(best);
    }
}

/// The nearest neighbour of cluster `i`.
fn find_nearest(clusters: &[Node], i: usize) -> Neighbour {
    let own = clusters[i].bounds();
    let others = clusters.iter().enumerate().map(|(j, other)| {
        let neighbour = Neighbour::new(own.union(other.bounds()).half_area(), j);
        if j == i { Neighbour::NONE } else { neighbour }
    });
    others.min().unwrap_or(Neighbour::NONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;

    #[test]
    fn cluster_numbers_are_those_of_aac_fast() {
        let f = |n| AacConfig::FAST.clusters(n);
        // 4^0.7 / 2 * n^0.3: 2 of 4, 4.6 of 64, 83.3 of a million; f(delta) of fewer.
        assert_eq!([f(2), f(3), f(4), f(64), f(1_000_000)], [2, 2, 2, 5, 84]);
        assert_eq!([1, 2, 3].map(|n| AacConfig { delta: 1, epsilon: 0.0 }.clusters(n)), [1, 1, 1]);
    }

    #[test]
    fn nearest_neighbours_are_merged_first() {
        use glam::Vec3A;
        let leaf = |x: f32, i| Node::leaf(Aabb::new(Vec3A::new(x, 0., 0.), Vec3A::new(x + 1., 1., 1.)), i, 1);
        let mut forest = Forest {
            clusters: vec![leaf(0., 0), leaf(10., 1), leaf(1., 2), leaf(11., 3)],
            free: vec![0, 1, 2],
            ..Forest::default()
        };
        let mut pairs = vec![[Node::ZERO; 2]; 3];
        combine(&mut forest, 0, 2, 0, &mut pairs);
        assert_eq!(forest.clusters.len(), 2);
        assert!(forest.clusters.iter().all(|c| c.count() == 2 && c.bounds().extent().x == 2.0));
    }
}
