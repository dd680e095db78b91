//! The top of an LBVH: sorted keys are partitioned down to treelets that fit a cache, each of which one task builds.

use super::key::MortonKey;
use super::partition::partition;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use std::sync::{Mutex, MutexGuard};

/// Most references of a treelet.
pub(crate) const TREELET: usize = 1 << 12;

/// The keys of a treelet.
struct Treelet<'a> {
    first: usize,
    depth: u32,
    keys: Mutex<&'a mut [MortonKey]>,
}

/// A subtree of the top.
#[derive(Clone, Copy, Debug)]
pub(crate) enum TopNode {
    /// Index of a treelet.
    Treelet(usize),
    /// Index of a pair.
    Pair(usize),
}

/// Treelets and the tree over them.
pub(crate) struct TopTree<'a> {
    treelets: Vec<Treelet<'a>>,
    /// Children before parents.
    pairs: Vec<[TopNode; 2]>,
}

impl<'a> TopTree<'a> {
    /// Divides one or more `keys`, which count as partitioned by the middle `depth` times before; keys of one code are
    /// reordered.
    pub fn new<G: Geometry>(refs: &PrimRefs<'_, G>, keys: &'a mut [MortonKey], depth: u32) -> Self {
        let mut top = Self { treelets: Vec::new(), pairs: Vec::new() };
        top.divide(refs, keys, 0, depth);
        top
    }

    fn divide<G: Geometry>(
        &mut self,
        refs: &PrimRefs<'_, G>,
        keys: &'a mut [MortonKey],
        first: usize,
        depth: u32,
    ) -> TopNode {
        if keys.len() <= TREELET {
            self.treelets.push(Treelet { first, depth, keys: Mutex::new(keys) });
            return TopNode::Treelet(self.treelets.len() - 1);
        }
        let mut below = depth;
        let split = partition(keys, refs, &mut below);
        let (left, right) = keys.split_at_mut(split);
        let left = self.divide(refs, left, first, below);
        let right = self.divide(refs, right, first + split, below);
        self.pairs.push([left, right]);
        TopNode::Pair(self.pairs.len() - 1)
    }

    /// Number of treelets.
    pub fn len(&self) -> usize {
        self.treelets.len()
    }

    /// The position of a treelet's first key, how often its keys were partitioned by the middle, and the keys, for the
    /// one task that builds it.
    pub fn treelet(&self, i: usize) -> (usize, u32, MutexGuard<'_, &'a mut [MortonKey]>) {
        let treelet = &self.treelets[i];
        (treelet.first, treelet.depth, treelet.keys.lock().expect("no task panics"))
    }

    /// The root.
    pub fn root(&self) -> TopNode {
        if self.pairs.is_empty() { TopNode::Treelet(0) } else { TopNode::Pair(self.pairs.len() - 1) }
    }

    /// The children of a pair.
    pub fn children(&self, pair: usize) -> [TopNode; 2] {
        self.pairs[pair]
    }

    /// The results of `join` for the children of each pair, bottom-up; `treelets` are the results for treelets.
    pub fn fold<T: Copy>(&self, treelets: &[T], mut join: impl FnMut([T; 2]) -> T) -> Vec<T> {
        let mut pairs: Vec<T> = Vec::with_capacity(self.pairs.len());
        for pair in &self.pairs {
            let children = pair.map(|child| *result_of(child, treelets, &pairs));
            pairs.push(join(children));
        }
        pairs
    }
}

/// The result for a node among those for treelets and pairs.
pub(crate) fn result_of<'a, T>(node: TopNode, treelets: &'a [T], pairs: &'a [T]) -> &'a T {
    match node {
        TopNode::Treelet(treelet) => &treelets[treelet],
        TopNode::Pair(pair) => &pairs[pair],
    }
}
