//! Passes over the clusters until one is left.

use super::pass::{Merged, Pass, TASK};
use crate::builders::binary::node::Node;
use crate::builders::lbvh::key::MortonKey;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::memory::huge_pages;
use crate::memory::pool::Pool;
use crate::parallel::ordered_append;
use crate::simd::Isa;

/// A pass that merges fewer than one of so many clusters is followed by one that merges neighbours.
const SLOW: usize = 32;

/// Memory of the clustering, kept from build to build.
#[derive(Default)]
pub(crate) struct Clustering {
    clusters: Vec<Node>,
    next: Vec<Node>,
    tasks: Pool<Merged>,
}

impl Clustering {
    /// The root of the clusters of sorted `keys`, whose pairs go to `pairs`, those of a pass in the order of the
    /// clusters; `None` without keys.
    pub fn cluster<G: Geometry>(
        &mut self,
        (radius, isa): (usize, Isa),
        refs: &PrimRefs<'_, G>,
        keys: &[MortonKey],
        pairs: &mut Vec<[Node; 2]>,
    ) -> Option<Node> {
        pairs.clear();
        huge_pages::reserve(pairs, keys.len(), "pairs of clusters");
        let Self { clusters, next, tasks } = self;
        huge_pages::reserve(next, keys.len(), "clusters");
        clusters.clear();
        huge_pages::reserve(clusters, keys.len(), "clusters");
        let count = keys.len().div_ceil(TASK);
        ordered_append::append(count, tasks, clusters, pairs, |task, chunk: &mut Merged| {
            chunk.of_leaves(refs, keys, task);
        });
        let mut is_forced = false;
        while clusters.len() > 1 {
            next.clear();
            let pass = Pass { clusters, radius, is_forced, isa };
            if clusters.len() <= TASK {
                let mut merged = tasks.take();
                merged.make(&pass, 0);
                merged.append_to(next, pairs);
                tasks.put(merged);
            } else {
                let count = clusters.len().div_ceil(TASK);
                ordered_append::append(count, tasks, next, pairs, |task, merged: &mut Merged| {
                    merged.make(&pass, task);
                });
            }
            is_forced = (clusters.len() - next.len()) * SLOW < clusters.len();
            std::mem::swap(clusters, next);
        }
        clusters.pop()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::lbvh::key::key_of;
    use crate::builders::testing::mesh;
    use glam::Vec3;

    #[test]
    fn boxes_one_within_another_take_few_passes() {
        let n = 50_000;
        let mesh = mesh(n, 1, |i, _| {
            let size = 1.0 + i as f32;
            [Vec3::splat(-size), Vec3::new(size, -size, 0.0), Vec3::splat(size)]
        });
        let refs = PrimRefs { geometry: &mesh, fragments: &[] };
        let keys: Vec<MortonKey> = (0..n as u32).map(|i| key_of(0, i)).collect();
        let mut pairs = Vec::new();
        let root = Clustering::default().cluster((8, Isa::best()), &refs, &keys, &mut pairs).unwrap();
        assert_eq!((root.count() as usize, pairs.len()), (n, n - 1));
        let mut depths = vec![0; pairs.len()];
        for (i, pair) in pairs.iter().enumerate() {
            let below = pair.iter().filter_map(Node::pair).map(|pair| depths[pair] + 1);
            depths[i] = below.max().unwrap_or(0);
        }
        assert!(depths[n - 2] < 50, "{}", depths[n - 2]);
    }
}
