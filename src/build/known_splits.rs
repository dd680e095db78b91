//! Binary subtrees all of whose splits are known, made wide at once.

use super::binary::Node;
use super::piece::{Piece, Subtree};
use super::references::References;
use super::top_down::{Kind, QUARTET, WIDTH};
use crate::bvh::{Link, MAX_LEAF_BLOCKS};
use crate::geometry::Aabb;
use arrayvec::ArrayVec;

/// What knows the splits below a node.
pub(super) trait KnownSplits {
    /// The children of a node that is to be split: one that is no [`Kind::Leaf`].
    fn children(&self, node: &Node) -> [Node; 2];

    /// Gives `take` the triangles below a node in the order of the tree.
    fn prims(&self, node: &Node, take: impl FnMut(u32));

    /// What is to become of `node`: a leaf of at most `max_leaf` triangles where that costs no more than a node with
    /// both children as leaves; a leaf costs its blocks, a node one.
    #[inline]
    fn kind(&self, node: &Node, max_leaf: u32) -> Kind {
        if node.count() <= QUARTET {
            return Kind::Leaf;
        }
        if node.count() > max_leaf {
            return Kind::Inner;
        }
        let leaf = |node: &Node| node.bounds().half_area() * node.count().div_ceil(QUARTET) as f32;
        let [left, right] = self.children(node);
        let is_soft = leaf(node) <= node.bounds().half_area() + (leaf(&left) + leaf(&right));
        if is_soft { Kind::SoftLeaf } else { Kind::Inner }
    }

    /// Appends to `piece` the wide nodes below `node`, opening the largest first, as
    /// [`super::top_down::TopDown::children`]. `None` if there are splits below `levels` others: `piece` is then to be
    /// put back. Counts binary splits.
    fn wide(
        &self,
        node: &Node,
        kind: Kind,
        levels: u32,
        leaves: &Leaves<'_>,
        piece: &mut Piece,
        splits: &mut u64,
    ) -> Option<Subtree> {
        if kind != Kind::Inner {
            let link = self.leaf(node, leaves, piece);
            return Some(link.map(|link| (node.bounds(), link)));
        }
        let mut children: ArrayVec<Child, WIDTH> = ArrayVec::new();
        let child = |node: Node, levels: u32| Child {
            node,
            kind: self.kind(&node, leaves.most),
            area: node.bounds().half_area(),
            levels,
        };
        let below = levels.checked_sub(1)?;
        children.extend(self.children(node).map(|node| child(node, below)));
        while children.len() < WIDTH {
            let largest = |kind: Kind| {
                let of_kind = (0..children.len()).filter(|&i| children[i].kind == kind);
                of_kind.reduce(|a, b| if children[b].area > children[a].area { b } else { a })
            };
            let Some(next) = largest(Kind::Inner).or_else(|| largest(Kind::SoftLeaf)) else { break };
            let below = children[next].levels.checked_sub(1)?;
            let [left, right] = self.children(&children[next].node).map(|node| child(node, below));
            children[next] = left;
            children.insert(next + 1, right);
        }
        let mut built: ArrayVec<(Aabb, Link), WIDTH> = ArrayVec::new();
        for Child { node, kind, levels, .. } in &children {
            built.extend(self.wide(node, *kind, *levels, leaves, piece, splits)?);
        }
        *splits += children.len() as u64 - 1;
        Some(piece.node(&built))
    }

    /// Appends the leaf of the triangles below `node`.
    #[inline]
    fn leaf(&self, node: &Node, leaves: &Leaves<'_>, piece: &mut Piece) -> Option<Link> {
        let mut prims = ArrayVec::<u32, { QUARTET as usize * MAX_LEAF_BLOCKS }>::new();
        self.prims(node, |prim| prims.push(prim));
        if !leaves.references.fragments.is_empty() {
            // Parts of one triangle may meet in a leaf.
            prims.sort_unstable();
            let mut last = None;
            prims.retain(|prim| last.replace(*prim) != Some(*prim));
        }
        piece.leaf(leaves.references.mesh, &prims)
    }
}

/// How leaves are made.
pub(super) struct Leaves<'a> {
    /// What they refer to.
    pub references: &'a References<'a>,
    /// Most triangles of a leaf that saves a node.
    pub most: u32,
}

/// A child of a wide node in the making.
struct Child {
    node: Node,
    kind: Kind,
    area: f32,
    /// Splits that there may be below, one below the other.
    levels: u32,
}
