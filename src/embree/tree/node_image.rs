//! A tree of ours as Embree's nodes and leaves in memory, for [`super::graft`]: one layout for all trees.

use super::layout::{Node, Triangle4, Unavailable, reference};
use super::pages::Pages;
use crate::bvh::{Child, MAX_DEPTH, MAX_LEAF_BLOCKS, TriangleBlock, WideBvh, WideNode};
use crate::embree::scene::GEOMETRY;
use crate::geometry::Hit;

/// A tree in Embree's layout. References are addresses within, so nothing may be moved or changed.
pub(super) struct NodeImage<const N: usize> {
    root: u64,
    nodes: Pages<Node<N>>,
    leaves: Pages<Triangle4>,
}

impl<const N: usize> NodeImage<N> {
    /// Lays `tree` out depth first. Trees that Embree's kernels could not walk are refused: references beyond
    /// the tree, more nodes or blocks than it has (some are used twice), more than [`MAX_DEPTH`] levels, triangles
    /// beyond `triangles`.
    pub fn of(tree: &WideBvh<N>, triangles: usize) -> Result<Self, Unavailable> {
        let mut nodes: Pages<Node<N>> = Pages::with_capacity(tree.nodes.len())?;
        let mut leaves: Pages<Triangle4> = Pages::with_capacity(tree.blocks.len())?;
        let (first_node, first_leaf) =
            (nodes.start().expose_provenance(), leaves.start().expose_provenance());
        let mut root = reference::EMPTY;
        let mut stack = vec![(tree.root, 0, None)];
        while let Some((link, depth, parent)) = stack.pop() {
            let placed = match link.get() {
                Child::Empty => reference::EMPTY,
                Child::Inner(index) => {
                    let Some(node) = tree.nodes.get(index) else {
                        return Unavailable::because(format_args!("the tree has no node {index}"));
                    };
                    if nodes.len() == tree.nodes.len() {
                        return Unavailable::because(format_args!(
                            "a node above or at {index} has two parents"
                        ));
                    }
                    if depth == MAX_DEPTH {
                        return Unavailable::because(format_args!(
                            "the tree has more than {MAX_DEPTH} levels"
                        ));
                    }
                    let place = nodes.len();
                    nodes.push(embree_node(node));
                    let used = node.links.iter().take_while(|link| !link.is_empty()).count();
                    if node.links[used..].iter().any(|link| !link.is_empty()) {
                        return Unavailable::because(format_args!(
                            "node {index} has a gap between its children"
                        ));
                    }
                    let children = (0..used).rev();
                    stack.extend(children.map(|slot| (node.links[slot], depth + 1, Some((place, slot)))));
                    reference::inner(first_node + place * size_of::<Node<N>>())
                }
                Child::Leaf { first, count } => {
                    let Some(blocks) = tree.blocks.get(first..first + count) else {
                        return Unavailable::because(format_args!(
                            "the tree has no block {}",
                            first + count - 1
                        ));
                    };
                    if count > MAX_LEAF_BLOCKS {
                        return Unavailable::because(format_args!(
                            "a leaf from {first} on has {count} blocks"
                        ));
                    }
                    if leaves.len() + count > tree.blocks.len() {
                        return Unavailable::because(format_args!(
                            "a block before or at {first} is in two leaves"
                        ));
                    }
                    if let Some(prim) =
                        blocks.iter().flat_map(|block| block.ids()).find(|&p| p as usize >= triangles)
                    {
                        return Unavailable::because(format_args!("the mesh has no triangle {prim}"));
                    }
                    let place = leaves.len();
                    blocks.iter().for_each(|block| leaves.push(embree_block(block)));
                    reference::leaf(first_leaf + place * size_of::<Triangle4>(), count)
                }
            };
            match parent {
                Some((node, slot)) => {
                    let node: &mut Node<N> = &mut nodes[node];
                    node.children[slot] = placed;
                }
                None => root = placed,
            }
        }
        Ok(Self { root, nodes, leaves })
    }

    /// Reference to the root, valid while the image lives.
    pub fn root(&self) -> u64 {
        self.root
    }

    /// Bytes of nodes and leaves.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.leaves[..])
    }
}

/// The node with its boxes; children are set as they are placed.
fn embree_node<const N: usize>(node: &WideNode<N>) -> Node<N> {
    let mut planes = [[[f32::INFINITY; N], [f32::NEG_INFINITY; N]]; 3];
    for slot in (0..N).filter(|&slot| !node.links[slot].is_empty()) {
        for (axis, planes) in planes.iter_mut().enumerate() {
            planes[0][slot] = node.lower[axis][slot];
            planes[1][slot] = node.upper[axis][slot];
        }
    }
    Node { children: [reference::EMPTY; N], planes }
}

fn embree_block(block: &TriangleBlock) -> Triangle4 {
    let geometries = block.prims.map(|prim| if prim == Hit::NONE { u32::MAX } else { GEOMETRY });
    Triangle4 { v0: block.v0, e1: block.e1, e2: block.e2, geometries, prims: block.prims }
}
