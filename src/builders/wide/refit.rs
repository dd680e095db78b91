//! Refitting a wide tree to a mesh that has moved: leaf data and boxes are made anew bottom-up, the topology stays.
//! Where triangles were split, each of the leaves that hold one now has its whole box.
//!
//! Trees come from anywhere, so nothing is known of the order of their nodes. Boxes are gathered depth first, where all
//! builders have put neighbours, into an array of their own, and then written to the nodes in the order of these.

use crate::builders::api::config_error::ConfigError;
use crate::bvh::{Child, Invalid, LeafBlock, Link, MAX_DEPTH, TriangleBlock, WideBvh, WideNode};
use crate::geometry::{Aabb, Mesh};
use crate::memory::{OutOfMemory, catch_out_of_memory, huge_pages};
use crate::parallel;
use glam::Vec3A;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

/// Nodes or blocks of one task.
const GRAIN: usize = 1 << 10;
/// Nodes less deep than this have their children refitted in parallel.
const PARALLEL_DEPTH: usize = 5;

/// Why a tree cannot be fitted to a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
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
    /// A parameter of the tree over the static part.
    #[error(transparent)]
    Parameter(#[from] ConfigError),
    /// The tree is no tree.
    #[error("{0}; build a new tree")]
    Malformed(#[from] Invalid),
    /// No memory for its boxes.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
}

impl<const N: usize> WideBvh<N> {
    /// Fits the tree to `mesh`, the one it was built over with vertices moved, in parallel on the current rayon pool.
    ///
    /// # Errors
    /// A mesh of another number of triangles, blocks whose used lanes do not come first, or no memory: the tree is as
    /// before then. Links that are not those of a tree: it is of no use then.
    pub fn refit(&mut self, mesh: &Mesh) -> Result<(), RefitError> {
        catch_out_of_memory(|| self.fit(mesh))?
    }

    fn fit(&mut self, mesh: &Mesh) -> Result<(), RefitError> {
        let (last, gaps): (Vec<_>, Vec<_>) = parallel::map(self.blocks.chunks(GRAIN), |blocks| {
            (
                blocks.iter().flat_map(TriangleBlock::ids).max(),
                blocks.iter().position(TriangleBlock::is_gapped),
            )
        })
        .into_iter()
        .unzip();
        if let Some((chunk, Some(at))) = gaps.into_iter().enumerate().find(|(_, gap)| gap.is_some()) {
            return Err(Invalid::Block(chunk * GRAIN + at).into());
        }
        let triangles = last.into_iter().flatten().max().map_or(0, |last| last as usize + 1);
        if triangles != mesh.len() {
            return Err(RefitError::Triangles { tree: triangles, mesh: mesh.len() });
        }

        let mut of_blocks = Vec::new();
        huge_pages::resize(&mut of_blocks, self.blocks.len(), Aabb::EMPTY, "boxes of leaf blocks");
        // Before anything is changed: want of memory unwinds.
        let mut of_nodes: Vec<NodeBox> = Vec::new();
        huge_pages::resize_with(&mut of_nodes, self.nodes.len(), NodeBox::default, "boxes of nodes");
        let chunks = self.blocks.chunks_mut(GRAIN).zip(of_blocks.chunks_mut(GRAIN));
        parallel::for_each(chunks, |(blocks, boxes)| {
            blocks.iter_mut().zip(boxes).for_each(|(block, bounds)| *bounds = refill(block, mesh));
        });
        let boxes = FittedBoxes { of_nodes: &of_nodes, of_blocks: &of_blocks };
        self.bounds = boxes.gather(&self.nodes, self.root, 0)?;
        let chunks = self.nodes.chunks_mut(GRAIN).zip(of_nodes.chunks(GRAIN));
        parallel::for_each(chunks, |(nodes, places)| {
            // Nothing is known of what nodes that are never reached lead to.
            let reached = nodes.iter_mut().zip(places).filter(|(_, place)| place.is_reached.load(Relaxed));
            for (node, _) in reached {
                *node = WideNode::of_slots(&node.links.map(|link| boxes.known(link)), node.links);
            }
        });
        Ok(())
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

/// The box of a node, written by the one task that comes to it.
#[derive(Default)]
struct NodeBox {
    corners: [AtomicU32; 6],
    is_reached: AtomicBool,
}

impl NodeBox {
    fn set(&self, bounds: Aabb) {
        let corners = [bounds.min.to_array(), bounds.max.to_array()];
        self.corners
            .iter()
            .zip(corners.as_flattened())
            .for_each(|(place, x)| place.store(x.to_bits(), Relaxed));
    }

    fn get(&self) -> Aabb {
        let [a, b, c, d, e, f] = self.corners.each_ref().map(|place| f32::from_bits(place.load(Relaxed)));
        Aabb::new(Vec3A::new(a, b, c), Vec3A::new(d, e, f))
    }
}

/// The new boxes of nodes and blocks.
struct FittedBoxes<'a> {
    of_nodes: &'a [NodeBox],
    of_blocks: &'a [Aabb],
}

impl FittedBoxes<'_> {
    /// The box of what a link refers to, with those of all nodes below.
    fn gather<const N: usize>(
        &self,
        nodes: &[WideNode<N>],
        link: Link,
        depth: usize,
    ) -> Result<Aabb, Invalid> {
        let index = match link.get() {
            Child::Empty => return Ok(Aabb::EMPTY),
            Child::Leaf { first, count } => {
                let blocks = self.of_blocks.get(first..first + count);
                let blocks = blocks.ok_or(Invalid::Link { what: "block", index: first + count - 1 })?;
                return Ok(blocks.iter().copied().collect());
            }
            Child::Inner(index) => index,
        };
        let place = self.of_nodes.get(index).filter(|place| !place.is_reached.swap(true, Relaxed));
        let place = place.ok_or(Invalid::Link { what: "node", index })?;
        if depth == MAX_DEPTH {
            return Err(Invalid::TooDeep);
        }
        let links = nodes[index].links;
        let of_child = |link| self.gather(nodes, link, depth + 1);
        let bounds: Aabb = if depth < PARALLEL_DEPTH {
            parallel::map(&links[..], |&link| of_child(link)).into_iter().collect::<Result<_, _>>()?
        } else {
            links.into_iter().map(of_child).collect::<Result<_, _>>()?
        };
        place.set(bounds);
        Ok(bounds)
    }

    /// The box of what a link refers to, where those of nodes are known.
    fn known(&self, link: Link) -> Aabb {
        match link.get() {
            Child::Empty => Aabb::EMPTY,
            Child::Inner(index) => self.of_nodes[index].get(),
            Child::Leaf { first, count } => self.of_blocks[first..first + count].iter().copied().collect(),
        }
    }
}
