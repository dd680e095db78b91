//! The auxiliary BVH over one treelet, by one task. It needs no search: its topology follows from the deltas.

use super::cartesian::cartesian_tree;
use super::deltas::Deltas;
use super::equal_codes::EqualCodes;
use super::key::{MortonKey, reference};
use super::prefetch;
use crate::builders::binary::node::Node;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::bvh::limits::BLOCK;
use crate::geometry::Aabb;
use crate::parallel::ordered_append::{Chunk, Offset};

/// Which subtrees become leaves.
#[derive(Clone, Copy)]
pub(crate) struct LeafRule {
    /// Subtrees of at most this many references are leaves: 1 to 4.
    pub always: u32,
    /// Clusters, which are leaves too, have at most this many references.
    pub most: u32,
    /// Clusters have a box of at most this half area; finished ones one that fits a cube of it.
    pub area: f32,
}

impl LeafRule {
    /// Whether `count` references in a box are a leaf.
    #[inline]
    pub fn is_leaf(self, count: u32, bounds: Aabb) -> bool {
        count <= self.always || self.is_cluster(count, bounds)
    }

    /// Whether a box fits into a cube of the area: what lies in it, does too.
    #[inline]
    pub fn is_compact(self, bounds: Aabb) -> bool {
        let edge = bounds.extent().max_element();
        3.0 * edge * edge <= self.area
    }

    /// Whether `count` references in a box are a cluster; they are more than always are a leaf.
    #[inline]
    fn is_cluster(self, count: u32, bounds: Aabb) -> bool {
        count <= self.most && bounds.half_area() <= self.area
    }
}

/// The pairs of one treelet; links are relative to them.
#[derive(Default)]
pub(crate) struct LbvhTreelet {
    pairs: Vec<[Node; 2]>,
    /// Where the leaves begin, and where the last one ends.
    leaves: Vec<u32>,
    bounds: Vec<Aabb>,
    deltas: Deltas,
    equal_codes: EqualCodes,
    copied_keys: Vec<MortonKey>,
    copied_bounds: Vec<Aabb>,
}

impl LbvhTreelet {
    /// Builds the tree over `keys`, which begin at position `first` and have been partitioned by the middle `depth`
    /// times. Returns the root.
    pub fn build<G: Geometry>(
        &mut self,
        refs: &PrimRefs<'_, G>,
        keys: &mut [MortonKey],
        first: usize,
        depth: u32,
        rule: LeafRule,
    ) -> Node {
        // All boxes first: a plain loop has many loads from memory in flight, and more with prefetches.
        self.bounds.clear();
        self.bounds.extend(keys.iter().enumerate().map(|(i, &key)| {
            prefetch::ahead(refs.geometry, keys, i);
            refs.bounds(reference(key))
        }));
        let Self { equal_codes, bounds, deltas, leaves, copied_keys, copied_bounds, .. } = self;
        deltas.of_codes(keys);
        equal_codes.partition(deltas, keys.len(), [depth, rule.always], |i| bounds[i].center2());
        equal_codes.reorder(keys, copied_keys);
        equal_codes.reorder(bounds, copied_bounds);
        deltas.find_subtrees::<{ BLOCK as usize }>(rule.always);
        deltas.list_subtrees(leaves);
        if rule.always == 1 {
            self.merge::<1>(first, rule)
        } else {
            self.merge::<{ BLOCK as usize }>(first, rule)
        }
    }

    /// Makes the tree over leaves of at most `MOST` references, the first of which is at position `first`.
    fn merge<const MOST: usize>(&mut self, first: usize, rule: LeafRule) -> Node {
        let Self { pairs, leaves, bounds, deltas, .. } = self;
        pairs.clear();
        let leaf = |leaf: &[u32]| {
            let [begin, end] = [leaf[0] as usize, leaf[1] as usize];
            // Some boxes may be merged twice: a branch on the number of references could not be predicted.
            let all = (0..MOST).map(|i| bounds[(begin + i).min(end - 1)]).collect();
            (Node::leaf(all, first + begin, (end - begin) as u32), deltas.before(begin))
        };
        cartesian_tree(Node::ZERO, leaves.windows(2).map(leaf), |children| {
            let node = Node::inner(&children, pairs.len());
            if rule.is_cluster(node.count(), node.bounds()) {
                // Subtrees of a cluster are clusters.
                Node::leaf(node.bounds(), children[0].run().start, node.count())
            } else {
                pairs.push(children);
                node
            }
        })
    }
}

impl Chunk for LbvhTreelet {
    type A = [Node; 2];
    type B = ();

    fn elements(&self) -> (&[[Node; 2]], &[()]) {
        (&self.pairs, &[])
    }

    fn moved(pair: &[Node; 2], offset: Offset) -> [Node; 2] {
        pair.map(|node| node.moved(offset[0] as u32))
    }

    fn clear(&mut self) {
        self.pairs.clear();
    }
}
