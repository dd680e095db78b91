//! Refitting a wide tree to a mesh that has moved: leaf data and boxes are made anew bottom-up, the topology stays.
//! Where triangles were split, each of the leaves that hold one now has its whole box.

use crate::bvh::{Child, Invalid, Link, MAX_DEPTH, TriangleBlock, WideBvh, WideNode};
use crate::geometry::{Aabb, Mesh};
use crate::parallel;
use rayon::prelude::*;

/// Nodes or blocks of one task.
const GRAIN: usize = 1 << 10;

/// Why a tree cannot be fitted to a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RefitError {
    /// It was built over a mesh of another number of triangles.
    #[error("the tree is of {tree} triangles, the mesh of {mesh}; build a new tree")]
    Triangles {
        /// Triangles of the tree.
        tree: usize,
        /// Triangles of the mesh.
        mesh: usize,
    },
    /// Pieces of presplit needles have no vertices that could have moved.
    #[error("its needles were presplit, and pieces cannot be refitted; build it without `presplit`")]
    Presplit,
    /// The tree is no tree.
    #[error("{0}; build a new tree")]
    Malformed(#[from] Invalid),
}

impl<const N: usize> WideBvh<N> {
    /// Fits the tree to `mesh`, the one it was built over with vertices moved, in parallel on the current rayon pool.
    ///
    /// # Errors
    /// A mesh of another number of triangles, or links that are not those of a tree; nothing is changed then.
    pub fn refit(&mut self, mesh: &Mesh) -> Result<(), RefitError> {
        let last = parallel::map(self.blocks.par_chunks(GRAIN), |blocks| {
            blocks.iter().flat_map(TriangleBlock::ids).max()
        });
        let triangles = last.into_iter().flatten().max().map_or(0, |last| last as usize + 1);
        if triangles != mesh.len() {
            return Err(RefitError::Triangles { tree: triangles, mesh: mesh.len() });
        }
        let levels = self.levels()?;

        let of_chunks = parallel::map(self.blocks.par_chunks_mut(GRAIN), |blocks| {
            blocks.iter_mut().map(|block| refill(block, mesh)).collect::<Vec<Aabb>>()
        });
        let of_blocks = of_chunks.concat();
        let mut of_nodes = vec![Aabb::EMPTY; self.nodes.len()];
        for level in levels.iter().rev() {
            let boxes = parallel::map(level.par_chunks(GRAIN), |level| {
                let whole = |&index: &u32| {
                    let links = self.nodes[index as usize].links.iter();
                    links.map(|&link| bounds_of(link, &of_nodes, &of_blocks)).collect()
                };
                level.iter().map(whole).collect::<Vec<Aabb>>()
            });
            for (&index, bounds) in level.iter().zip(boxes.into_iter().flatten()) {
                of_nodes[index as usize] = bounds;
            }
        }
        parallel::for_each(self.nodes.par_chunks_mut(GRAIN), |nodes| {
            for node in nodes {
                let boxes = node.links.map(|link| bounds_of(link, &of_nodes, &of_blocks));
                *node = WideNode::of_slots(&boxes, node.links);
            }
        });
        self.bounds = bounds_of(self.root, &of_nodes, &of_blocks);
        Ok(())
    }

    /// The nodes by their depth.
    fn levels(&self) -> Result<Vec<Vec<u32>>, Invalid> {
        let mut seen = vec![false; self.nodes.len()];
        let mut levels: Vec<Vec<u32>> = Vec::new();
        let mut links = vec![self.root];
        while !links.is_empty() {
            let mut level = Vec::with_capacity(links.len());
            for link in links {
                match link.get() {
                    Child::Empty => {}
                    Child::Inner(index) => match seen.get_mut(index) {
                        Some(seen) if !*seen => {
                            *seen = true;
                            level.push(index as u32);
                        }
                        _ => return Err(Invalid::Link { what: "node", index }),
                    },
                    Child::Leaf { first, count } => {
                        if first + count > self.blocks.len() {
                            return Err(Invalid::Link { what: "block", index: first + count - 1 });
                        }
                    }
                }
            }
            if levels.len() == MAX_DEPTH && !level.is_empty() {
                return Err(Invalid::TooDeep);
            }
            links = level.iter().flat_map(|&index| self.nodes[index as usize].links).collect();
            levels.push(level);
        }
        Ok(levels)
    }
}

/// Writes the corners of a block's triangles again; returns their box.
fn refill(block: &mut TriangleBlock, mesh: &Mesh) -> Aabb {
    let (prims, count) = (block.prims, block.ids().count());
    if count == 0 {
        return Aabb::EMPTY;
    }
    // The unused lanes repeat the first: there is no branch on their number.
    let corners = prims.map(|prim| mesh.corners(if prim == u32::MAX { prims[0] } else { prim }));
    *block = TriangleBlock::of_corners(count, prims, corners);
    corners.into_iter().map(Aabb::of_triangle).collect()
}

/// The box of what a link refers to.
fn bounds_of(link: Link, of_nodes: &[Aabb], of_blocks: &[Aabb]) -> Aabb {
    match link.get() {
        Child::Empty => Aabb::EMPTY,
        Child::Inner(index) => of_nodes[index],
        Child::Leaf { first, count } => of_blocks[first..first + count].iter().copied().collect(),
    }
}
