//! Leaf blocks for the watertight tests: corners as the mesh has them. The blocks of the tree hold a corner and two
//! rounded edges, from which neighbours would not get the same bits for a corner that they share.

use crate::bvh::{TriangleBlock, WideBvh};
use crate::geometry::{Hit, Mesh};
use crate::memory::huge_pages;
use rayon::prelude::*;

/// Four triangles in structure-of-arrays form. Unused lanes hold zeros, which nothing hits.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct CornerBlock {
    /// `corners[corner][axis][lane]`.
    pub corners: [[[f32; 4]; 3]; 3],
    /// Triangle ids.
    pub prims: [u32; 4],
}

impl CornerBlock {
    fn of(block: &TriangleBlock, mesh: &Mesh) -> Self {
        let mut corners = [[[0.0; 4]; 3]; 3];
        for (lane, &prim) in block.prims.iter().enumerate().filter(|&(_, &prim)| prim != Hit::NONE) {
            for (planes, corner) in corners.iter_mut().zip(mesh.corners(prim)) {
                for (plane, x) in planes.iter_mut().zip(corner.to_array()) {
                    plane[lane] = x;
                }
            }
        }
        Self { corners, prims: block.prims }
    }
}

/// A block for each of `tree`, which was built over `mesh`. Unwinds to `catch_out_of_memory` where there is no memory
/// for them.
///
/// # Errors
/// One line, if the tree names a triangle that the mesh lacks.
pub(super) fn corner_blocks<const N: usize>(
    tree: &WideBvh<N>,
    mesh: &Mesh,
) -> Result<Vec<CornerBlock>, String> {
    // All lanes, as below: those of a malformed block may have gaps.
    let prims = tree.blocks.par_iter().flat_map_iter(|block| block.prims);
    let last = prims.filter(|&prim| prim != Hit::NONE).max();
    if let Some(prim) = last.filter(|&prim| prim as usize >= mesh.len()) {
        let triangles = mesh.len();
        return Err(format!(
            "the tree names triangle {prim} of a mesh of {triangles}; give the mesh of the tree"
        ));
    }
    let mut blocks = Vec::new();
    huge_pages::reserve(&mut blocks, tree.blocks.len(), "corners of triangles");
    blocks.par_extend(tree.blocks.par_iter().map(|block| CornerBlock::of(block, mesh)));
    Ok(blocks)
}
