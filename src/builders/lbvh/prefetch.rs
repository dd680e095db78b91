//! Hints to the memory system, where it cannot guess what is read next.

#![allow(unsafe_code)]

use crate::builders::binary::{BinaryTree, Node};
use crate::builders::lbvh::sort::{Key, reference};
use crate::builders::prims::refs::References;
use crate::geometry::Mesh;

/// Brings near the pairs and the triangles below `node`, which one thread is about to build, in a tree of leaves of up to
/// `leaf` references: their addresses depend on loads
/// themselves, and here many such are on their way at once.
pub(crate) fn warm(tree: &BinaryTree, keys: &[Key], references: &References<'_>, node: &Node, leaf: u32) {
    // In Morton order a subtree is a run; in other trees nearly so.
    let run = tree.run(node);
    let keys = &keys[run.start..keys.len().min(run.end)];
    // The pairs of a subtree lie in a row that ends with its root's; leaves of several references are half full.
    if let Some(pair) = node.pair() {
        let pairs = if leaf == 1 { keys.len() } else { keys.len() / 2 }.min(pair);
        (pair - pairs..pair).for_each(|pair| line(&tree.pairs, pair));
    }
    let (triangles, vertices) = (references.mesh.triangles(), references.mesh.padded_vertices());
    for key in keys {
        line(triangles, reference(*key) as usize);
    }
    for key in keys {
        if let Some(triangle) = triangles.get(reference(*key) as usize) {
            line(vertices, triangle[0] as usize);
        }
    }
}

/// Brings near triangles that the walk along `keys` that is at `i` comes to next.
#[inline]
pub(crate) fn triangle(mesh: &Mesh, keys: &[Key], i: usize) {
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

/// Brings near the corners, as indices, of a triangle that the walk along `keys` that is at `i` comes to next.
#[inline]
pub(crate) fn indices(mesh: &Mesh, keys: &[Key], i: usize) {
    const AHEAD: usize = 32;
    if let Some(&key) = keys.get(i + AHEAD) {
        line(mesh.triangles(), reference(key) as usize);
    }
}

/// Brings near the corners of a triangle.
#[inline]
pub(crate) fn corners(mesh: &Mesh, triangle: [u32; 3]) {
    triangle.iter().for_each(|&vertex| line(mesh.padded_vertices(), vertex as usize));
}

/// Asks for the cache line of `array[index]`; nothing happens beyond the array's end.
#[inline]
pub(crate) fn line<T>(array: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if index < array.len() {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: the address lies within the array; a prefetch reads nothing and cannot fault.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(array.as_ptr().add(index).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (array, index);
}
