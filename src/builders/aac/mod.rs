//! Approximate agglomerative clustering (Gu, He, Fatahalian, Blelloch 2013): Morton order parts the triangles
//! top-down, and clusters are merged bottom-up, at each step only down to f(n) of them. Made 4-wide like all.

pub(crate) mod collapse;

use crate::builders::aac::collapse::Collapse;
use crate::builders::binary::{BinaryTree, Node};
use crate::builders::builder::{Build, Builder, Counts, Stopwatch};
use crate::builders::lbvh::sort::{Key, MortonOrder, part, reference};
use crate::builders::prims::refs::References;
use crate::builders::wide::top_down::{self, Memory};
use crate::bvh::Bvh4;
use crate::geometry::Mesh;
use crate::memory::huge_pages;

/// Runs shorter than this are clustered by one thread.
const SERIAL: usize = 1 << 12;

/// Parameters of AAC.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct AacConfig {
    /// delta: runs of at most so many triangles are not parted further.
    pub delta: usize,
    /// epsilon of f(n) = delta^(0.5 + epsilon) / 2 * n^(0.5 - epsilon), the clusters left of n triangles.
    pub epsilon: f64,
}

impl AacConfig {
    /// AAC-Fast (Gu et al. 2013, section 4.1).
    pub const FAST: Self = Self { delta: 4, epsilon: 0.2 };

    fn clusters(&self, n: usize) -> usize {
        let clusters =
            (self.delta as f64).powf(0.5 + self.epsilon) / 2.0 * (n as f64).powf(0.5 - self.epsilon);
        // f(delta) is delta / 2 exactly, but for rounding.
        ((clusters + 1e-6) as usize).max(1)
    }
}

/// Builds by AAC; memory is kept between builds.
pub struct Aac {
    config: AacConfig,
    order: MortonOrder,
    tree: BinaryTree,
    memory: Memory<Vec<u32>>,
}

impl Aac {
    /// A builder with the given parameters.
    pub fn new(config: AacConfig) -> Self {
        Self { config, order: MortonOrder::default(), tree: BinaryTree::default(), memory: Memory::default() }
    }
}

impl Builder for Aac {
    fn name(&self) -> &'static str {
        "aac"
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!(self.config)
    }

    fn build(&mut self, mesh: &Mesh) -> Build {
        let mut watch = Stopwatch::start();
        self.order.sort(mesh, None, self.memory.blocks(mesh.len()), &mut watch);
        let mut all_keys = std::mem::take(&mut self.order.keys);
        let references = self.order.references(mesh);
        huge_pages::resize(&mut self.tree.pairs, mesh.len().saturating_sub(1), [Node::ZERO; 2]);
        let keys = &mut all_keys[..];
        self.tree.root = if keys.is_empty() {
            None
        } else {
            let mut forest = Forest::default();
            let clustering = Clustering { config: self.config, references };
            clustering.build(keys, 0, 0, &mut self.tree.pairs, &mut forest);
            combine(&mut forest, 0, 1, 0, &mut self.tree.pairs);
            forest.clusters.pop()
        };
        self.order.keys = all_keys;
        let references = self.order.references(mesh);
        watch.lap("clusters");
        let collapse = Collapse { tree: &self.tree, keys: &self.order.keys, references };
        let tree = top_down::build(&collapse, collapse.root(), &references, &mut self.memory);
        watch.lap("nodes");
        let held = self.order.bytes() + self.tree.bytes() + self.memory.bytes();
        let counts = Counts { auxiliary_nodes: 2 * mesh.len() as u64, ..Counts::default() };
        Build::finish(tree, watch.phases, counts, held)
    }

    fn recycle(&mut self, tree: Bvh4) {
        self.memory.recycle(tree);
    }
}

/// Clusters that wait for being merged, those of the current run last.
#[derive(Default)]
struct Forest {
    clusters: Vec<Node>,
    /// Places for pairs: always one less for a run than it has clusters.
    free: Vec<usize>,
    nearest: Vec<(f32, usize)>,
}

struct Clustering<'a> {
    config: AacConfig,
    references: References<'a>,
}

impl Clustering<'_> {
    /// Appends the clusters of a run of sorted keys that begins at `first`, whose pairs are `pairs`.
    fn build(
        &self,
        keys: &mut [Key],
        first: usize,
        depth: u32,
        pairs: &mut [[Node; 2]],
        forest: &mut Forest,
    ) {
        let len = keys.len();
        let begin = (forest.clusters.len(), forest.free.len());
        if len <= self.config.delta {
            let bounds = |key: Key| self.references.bounds(reference(key));
            forest
                .clusters
                .extend(keys.iter().enumerate().map(|(i, &key)| Node::leaf(bounds(key), first + i, 1)));
            forest.free.extend(first..first + len - 1);
        } else {
            let mut below = depth;
            let split = part(keys, &self.references, &mut below);
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
