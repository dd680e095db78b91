//! Where the triangles of a tree are: a hit's normal is computed from the block that the kernel has just read.

use super::BvhError;
use crate::bvh::TriangleBlock;
use crate::geometry::Mesh;
use crate::memory::{OutOfMemory, huge_pages};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Triangles of a mesh of which these are all blocks.
pub(super) fn triangles(blocks: &[TriangleBlock]) -> Result<usize, BvhError> {
    let length_of = |block: &TriangleBlock| block.ids().fold(0, |length, prim| length.max(prim as usize + 1));
    let length = blocks.par_iter().map(length_of).reduce(|| 0, usize::max);
    if length > Mesh::MAX_TRIANGLES {
        return Err(BvhError::Malformed(format!("triangle {} of no mesh", length - 1)));
    }
    Ok(length)
}

/// Where each of so many triangles is, four times its block plus its lane in it; one of the places if it is in several
/// blocks. They are written to the memory of `old` ones.
pub(super) fn places(
    blocks: &[TriangleBlock],
    triangles: usize,
    old: Vec<u32>,
) -> Result<Vec<u32>, OutOfMemory> {
    // Both conversions stay in place.
    let mut places: Vec<AtomicU32> = old.into_iter().map(AtomicU32::new).collect();
    places.truncate(triangles);
    huge_pages::try_reserve(&mut places, triangles, "places of triangles")?;
    places.resize_with(triangles, AtomicU32::default);
    blocks.par_iter().enumerate().for_each(|(index, block)| {
        let lanes = block.prims.iter().enumerate().filter(|(_, prim)| **prim != u32::MAX);
        for (lane, &prim) in lanes {
            places[prim as usize].store((4 * index + lane) as u32, Relaxed);
        }
    });
    Ok(places.into_iter().map(AtomicU32::into_inner).collect())
}
