//! The clustering: clusters of a run of Morton codes, merged from those of its halves.

use super::config::AacConfig;
use crate::builders::binary::node::Node;
use crate::builders::lbvh::key::{MortonKey, reference};
use crate::builders::lbvh::partition::partition;
use crate::builders::prims::refs::PrimRefs;

/// Runs shorter than this are clustered by one thread.
const SERIAL: usize = 1 << 12;

/// The root of the clusters of all `keys`, whose pairs go to `pairs`; `None` without keys.
pub(super) fn cluster(
    config: &AacConfig,
    refs: PrimRefs<'_>,
    keys: &mut [MortonKey],
    pairs: &mut [[Node; 2]],
) -> Option<Node> {
    let mut forest = Forest::default();
    if !keys.is_empty() {
        Clustering { config, refs }.build(keys, 0, 0, pairs, &mut forest);
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
    nearest: Vec<(f32, usize)>,
}

struct Clustering<'a> {
    config: &'a AacConfig,
    refs: PrimRefs<'a>,
}

impl Clustering<'_> {
    /// Appends the clusters of a run of sorted keys that begins at `first`, whose pairs are `pairs`.
    fn build(
        &self,
        keys: &mut [MortonKey],
        first: usize,
        depth: u32,
        pairs: &mut [[Node; 2]],
        forest: &mut Forest,
    ) {
        let len = keys.len();
        let begin = (forest.clusters.len(), forest.free.len());
        if len <= self.config.delta {
            let bounds = |key: MortonKey| self.refs.bounds(reference(key));
            forest
                .clusters
                .extend(keys.iter().enumerate().map(|(i, &key)| Node::leaf(bounds(key), first + i, 1)));
            forest.free.extend(first..first + len - 1);
        } else {
            let mut below = depth;
            let split = partition(keys, &self.refs, &mut below);
            let (left, right) = keys.split_at_mut(split);
            let (left_pairs, right_pairs) = pairs.split_at_mut(split - 1);
            let right_pairs = &mut right_pairs[1..];
            if len < SERIAL {
                self.build(left, first, below, left_pairs, forest);
                self.build(right, first + split, below, right_pairs, forest);
            } else {
                let mut other = Forest::default();
                rayon::join(
                    || self.build(left, first, below, left_pairs, forest),
                    || self.build(right, first + split, below, right_pairs, &mut other),
                );
                forest.clusters.append(&mut other.clusters);
                forest.free.append(&mut other.free);
            }
            forest.free.push(first + split - 1);
        }
        debug_assert_eq!(forest.clusters.len() - begin.0, forest.free.len() - begin.1 + 1);
        combine(forest, begin.0, self.config.clusters(len), first, pairs);
    }
}

/// Merges the clusters from position `begin` on, always the nearest two, until `target` are left. Distance is
/// the area of the common box. `pairs` begins with the pair `first`.
fn combine(forest: &mut Forest, begin: usize, target: usize, first: usize, pairs: &mut [[Node; 2]]) {
    let Forest { clusters, free, nearest } = forest;
    let count = |clusters: &Vec<Node>| clusters.len() - begin;
    if count(clusters) <= target {
        return;
    }
    nearest.clear();
    nearest.extend((0..count(clusters)).map(|i| find_nearest(&clusters[begin..], i)));
    while count(clusters) > target {
        let (i, _) = nearest
            .iter()
            .enumerate()
            .min_by(|(_, a), (_, b)| a.0.total_cmp(&b.0))
            .expect("more clusters than the target, which is one at least");
        let (a, b) = (i.min(nearest[i].1), i.max(nearest[i].1));
        let place = free.pop().expect("a run has a free pair less than clusters");
        pairs[place - first] = [clusters[begin + a], clusters[begin + b]];
        clusters[begin + a] = Node::inner(&pairs[place - first], place);
        // The last takes the place of b.
        let last = count(clusters) - 1;
        clusters.swap_remove(begin + b);
        nearest.swap_remove(b);
        for (k, near) in nearest.iter_mut().enumerate() {
            if k == a || near.1 == a || near.1 == b {
                *near = find_nearest(&clusters[begin..], k);
            } else if near.1 == last {
                near.1 = b;
            }
        }
    }
}

/// The cluster nearest to cluster `i`, and its distance; the first of equal ones.
fn find_nearest(clusters: &[Node], i: usize) -> (f32, usize) {
    let own = clusters[i].bounds();
    let mut best = (f32::INFINITY, usize::MAX);
    for (j, other) in clusters.iter().enumerate() {
        let area = own.union(other.bounds()).half_area();
        // Areas may overflow to infinity; any neighbour is better than none.
        if j != i && (area < best.0 || best.1 == usize::MAX) {
            best = (area, j);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;

    #[test]
    fn cluster_numbers_are_those_of_aac_fast() {
        let f = |n| AacConfig::FAST.clusters(n);
        // 4^0.7 / 2 * n^0.3: 2 of 4, 4.6 of 64, 83.3 of a million.
        assert_eq!([f(4), f(64), f(1_000_000)], [2, 4, 83]);
        assert_eq!(f(1), 1);
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
