//! Binary subtrees all of whose splits are known, made wide at once.

use crate::builders::binary::Node;
use crate::builders::prims::refs::References;
use crate::builders::wide::top_down::{Kind, QUARTET, WIDTH};
use crate::builders::wide::treelet::{Piece, Subtree};
use crate::bvh::{Link, MAX_LEAF_BLOCKS};
use crate::geometry::{Aabb, Mesh};
use arrayvec::ArrayVec;

/// A subtree whose triangles are a run.
#[derive(Clone, Copy)]
pub(crate) struct At {
    /// Its root.
    pub node: Node,
    /// The place of its first triangle.
    pub first: u32,
}

/// What knows the splits of binary subtrees.
pub(crate) trait KnownSplits {
    /// The children of what is to be split: what is no [`Kind::Leaf`].
    fn children(&self, at: &At) -> [At; 2];

    /// The triangle at a place.
    fn prim(&self, place: usize) -> u32;

    /// What is to become of a subtree.
    #[inline(always)]
    fn kind(&self, at: &At, max_leaf: u32) -> Kind {
        kind(&at.node, max_leaf, || self.children(at).map(|child| child.node))
    }

    /// Appends to `piece` the wide nodes of a subtree, opening the largest first, as
    /// [`crate::builders::wide::top_down::TopDown::children`]. `None` if there are splits below `levels` others: `piece` is then to be
    /// put back. Counts binary splits.
    fn wide(
        &self,
        at: &At,
        kind: Kind,
        levels: u32,
        leaves: &Leaves<'_>,
        piece: &mut Piece,
        splits: &mut u64,
    ) -> Option<Subtree> {
        if kind != Kind::Inner {
            let link = self.leaf(at, leaves, piece);
            return Some(link.map(|link| (at.node.bounds(), link)));
        }
        let below = levels.checked_sub(1)?;
        let mut children: ArrayVec<Child, WIDTH> = ArrayVec::new();
        let child = |at: At, levels: u32| Child::new(at, self.kind(&at, leaves.most), levels);
        children.extend(self.children(at).map(|at| child(at, below)));
        while children.len() < WIDTH {
            let first = (0, children[0].order);
            let later = children.iter().map(|child| child.order).enumerate().skip(1);
            let (next, order) = later.fold(first, |best, other| if other.1 > best.1 { other } else { best });
            if order < Child::SOFT {
                break;
            }
            let below = children[next].levels.checked_sub(1)?;
            let [left, right] = self.children(&children[next].at).map(|at| child(at, below));
            children[next] = left;
            children.insert(next + 1, right);
        }
        let mut built: ArrayVec<(Aabb, Link), WIDTH> = ArrayVec::new();
        for Child { at, kind, levels, .. } in &children {
            built.extend(self.wide(at, *kind, *levels, leaves, piece, splits)?);
        }
        *splits += children.len() as u64 - 1;
        Some(piece.node(&built))
    }

    /// Appends the leaf of a subtree's triangles.
    #[inline]
    fn leaf(&self, at: &At, leaves: &Leaves<'_>, piece: &mut Piece) -> Option<Link> {
        let places = at.first as usize..(at.first + at.node.count()) as usize;
        let mesh = leaves.mesh;
        if !leaves.may_repeat && places.len() <= QUARTET as usize {
            let prims = std::array::from_fn(|lane| self.prim((places.start + lane).min(places.end - 1)));
            return Some(piece.quartet(mesh, places.len(), prims));
        }
        let mut prims: ArrayVec<u32, { QUARTET as usize * MAX_LEAF_BLOCKS }> =
            places.map(|place| self.prim(place)).collect();
        if leaves.may_repeat {
            // Parts of one triangle may meet in a leaf.
            prims.sort_unstable();
            let mut last = None;
            prims.retain(|prim| last.replace(*prim) != Some(*prim));
        }
        piece.leaf(mesh, &prims)
    }
}

/// What is to become of `node`: a leaf of at most `max_leaf` triangles where that costs no more than a node with both
/// children as leaves; a leaf costs its blocks, a node one.
#[inline(always)]
pub(crate) fn kind(node: &Node, max_leaf: u32, children: impl FnOnce() -> [Node; 2]) -> Kind {
    if node.count() <= QUARTET {
        return Kind::Leaf;
    }
    if node.count() > max_leaf {
        return Kind::Inner;
    }
    let leaf = |node: &Node| node.bounds().half_area() * node.count().div_ceil(QUARTET) as f32;
    let [left, right] = children();
    let is_soft = leaf(node) <= node.bounds().half_area() + (leaf(&left) + leaf(&right));
    if is_soft { Kind::SoftLeaf } else { Kind::Inner }
}

/// How leaves are made.
pub(crate) struct Leaves<'a> {
    /// The triangles.
    pub mesh: &'a Mesh,
    /// Most triangles of a leaf that saves a node.
    pub most: u32,
    /// Whether parts of one triangle may meet in a leaf.
    pub may_repeat: bool,
}

impl<'a> Leaves<'a> {
    /// Of references, each of which is in one leaf.
    pub fn of(references: &References<'a>, most: u32) -> Self {
        Self { mesh: references.mesh, most, may_repeat: !references.fragments.is_empty() }
    }
}

/// A child of a wide node in the making.
struct Child {
    at: At,
    kind: Kind,
    /// The greatest is split first: the largest of those to be split, then of those that may be.
    order: u64,
    /// Splits that there may be below, one below the other.
    levels: u32,
}

impl Child {
    /// The least order of what may be split.
    const SOFT: u64 = 1 << 32;

    #[inline(always)]
    fn new(at: At, kind: Kind, levels: u32) -> Self {
        let class = match kind {
            Kind::Inner => 2,
            Kind::SoftLeaf => 1,
            Kind::Leaf => 0,
        };
        // Areas are not negative: their bits are in their order.
        let order = class << 32 | u64::from(at.node.bounds().half_area().to_bits());
        Self { at, kind, order, levels }
    }
}
