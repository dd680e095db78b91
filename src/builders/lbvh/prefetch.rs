//! Prefetches along sorted keys: the processor cannot guess which primitive is read next.

use super::key::{MortonKey, reference};
use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::memory::prefetch::line;

/// Prefetches the pairs and the primitives below `node`, which one thread is about to build, in a tree of leaves of
/// up to `leaf` references. Their addresses depend on loads; here many such loads are in flight at once.
pub(crate) fn subtree<G: Geometry>(
    tree: &BinaryTree,
    keys: &[MortonKey],
    refs: &PrimRefs<'_, G>,
    node: &Node,
    leaf: u32,
) {
    // The pairs of a subtree lie in a row that ends with its root's; leaves of several references are half full.
    if let Some(pair) = node.pair() {
        let count = node.count() as usize;
        let pairs = if leaf == 1 { count } else { count / 2 }.min(pair);
        (pair - pairs..pair).for_each(|pair| line(&tree.pairs, pair));
    }
    run(tree, keys, refs, node);
}

/// Prefetches the primitives below `node`: in Morton order a subtree is a run, in other trees nearly so.
pub(crate) fn run<G: Geometry>(tree: &BinaryTree, keys: &[MortonKey], refs: &PrimRefs<'_, G>, node: &Node) {
    let run = tree.run(node);
    primitives(refs.geometry, &keys[run.start..keys.len().min(run.end)]);
}

/// Prefetches the primitives of a run of keys that one thread is about to use.
pub(crate) fn primitives(geometry: &impl Geometry, keys: &[MortonKey]) {
    for key in keys {
        geometry.prefetch(reference(*key));
    }
    for key in keys {
        geometry.prefetch_first_corner(reference(*key));
    }
}

/// Prefetches the primitives that a walk along `keys`, now at `i`, comes to next.
#[inline]
pub(crate) fn ahead(geometry: &impl Geometry, keys: &[MortonKey], i: usize) {
    const AHEAD: usize = 16;
    far_ahead(geometry, keys, i);
    if let Some(&key) = keys.get(i + AHEAD) {
        geometry.prefetch_corners(reference(key));
    }
}

/// Prefetches of a primitive that a walk along `keys`, now at `i`, comes to next what its corners are found by.
#[inline]
pub(crate) fn far_ahead(geometry: &impl Geometry, keys: &[MortonKey], i: usize) {
    const AHEAD: usize = 32;
    if let Some(&key) = keys.get(i + AHEAD) {
        geometry.prefetch(reference(key));
    }
}
