//! Prefetches along sorted keys: the processor cannot guess which triangle is read next.

use super::key::{MortonKey, reference};
use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::prims::refs::PrimRefs;
use crate::geometry::Mesh;
use crate::memory::prefetch::line;

/// Prefetches the pairs and the triangles below `node`, which one thread is about to build, in a tree of leaves of up to
/// `leaf` references. Their addresses depend on loads; here many such loads are in flight at once.
pub(crate) fn subtree(tree: &BinaryTree, keys: &[MortonKey], refs: &PrimRefs<'_>, node: &Node, leaf: u32) {
    // The pairs of a subtree lie in a row that ends with its root's; leaves of several references are half full.
    if let Some(pair) = node.pair() {
        let count = node.count() as usize;
        let pairs = if leaf == 1 { count } else { count / 2 }.min(pair);
        (pair - pairs..pair).for_each(|pair| line(&tree.pairs, pair));
    }
    run(tree, keys, refs, node);
}

/// Prefetches the triangles below `node`: in Morton order a subtree is a run, in other trees nearly so.
pub(crate) fn run(tree: &BinaryTree, keys: &[MortonKey], refs: &PrimRefs<'_>, node: &Node) {
    let run = tree.run(node);
    triangles(refs.mesh, &keys[run.start..keys.len().min(run.end)]);
}

/// Prefetches the triangles of a run of keys that one thread is about to use.
pub(crate) fn triangles(mesh: &Mesh, keys: &[MortonKey]) {
    let (triangles, vertices) = (mesh.triangles(), mesh.padded_vertices());
    for key in keys {
        line(triangles, reference(*key) as usize);
    }
    for key in keys {
        if let Some(triangle) = triangles.get(reference(*key) as usize) {
            line(vertices, triangle[0] as usize);
        }
    }
}

/// Prefetches the triangles that a walk along `keys`, now at `i`, comes to next.
#[inline]
pub(crate) fn triangle(mesh: &Mesh, keys: &[MortonKey], i: usize) {
    const AHEAD: usize = 16;
    if let Some(&key) = keys.get(i + 2 * AHEAD) {
        line(mesh.triangles(), reference(key) as usize);
    }
    if let Some(&key) = keys.get(i + AHEAD)
        && let Some(triangle) = mesh.triangles().get(reference(key) as usize)
    {
        triangle.iter().for_each(|&vertex| line(mesh.padded_vertices(), vertex as usize));
    }
}

/// Prefetches the vertex indices of a triangle that a walk along `keys`, now at `i`, comes to next.
#[inline]
pub(crate) fn indices(mesh: &Mesh, keys: &[MortonKey], i: usize) {
    const AHEAD: usize = 32;
    if let Some(&key) = keys.get(i + AHEAD) {
        line(mesh.triangles(), reference(key) as usize);
    }
}

/// Prefetches the corners of a triangle.
#[inline]
pub(crate) fn corners(mesh: &Mesh, triangle: [u32; 3]) {
    triangle.iter().for_each(|&vertex| line(mesh.padded_vertices(), vertex as usize));
}
