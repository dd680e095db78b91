//! Cuts of a single node: what is below is settled. To be split the node is opened into its two children, whatever
//! the threshold (paper 4.2), and either side of that split is a single node again: the binary splits are those that
//! the auxiliary BVH has. In scenes of much detail that is most of them, and nothing has to be refined for them.

use crate::builders::binary::{BinaryTree, Node};
use crate::builders::builder::Counts;
use crate::builders::phr::cut::{Cut, Order, Stage, is_whole};
use crate::builders::phr::policy::{Refine, Rules};
use crate::builders::phr::recursion::{CutRecursion, MAX_DEPTH, Scratch};
use crate::builders::split::cost::Weight;
use crate::builders::split::object::two;
use crate::builders::wide::largest_first::{At, KnownSplits, Leaves};
use crate::builders::wide::top_down::{Kind, QUARTET};
use crate::builders::wide::treelet::{Piece, Subtree};

/// The splits of an auxiliary BVH over single references.
pub(crate) struct Settled<'a> {
    tree: &'a BinaryTree,
    order: &'a Order<'a>,
}

impl KnownSplits for Settled<'_> {
    #[inline(always)]
    fn children(&self, at: &At) -> [At; 2] {
        let [a, b] = self.tree.children(&at.node);
        let children = [At { node: *a, first: at.first }, At { node: *b, first: at.first + a.count() }];
        let split = two(a, b, Weight::Nodes.limit(at.node.bounds().half_area(), 2));
        // Without a gain they are halved in the order of the Morton codes.
        let is_swapped = split.left == 1 && split.last == 1;
        if is_swapped { [children[1], children[0]] } else { children }
    }

    #[inline(always)]
    fn prim(&self, place: usize) -> u32 {
        self.order.prim(place)
    }
}

impl<R: Refine> CutRecursion<'_, R> {
    fn known(&self) -> Settled<'_> {
        Settled { tree: self.tree, order: &self.order }
    }

    /// The single node of a cut that needs no refining, is not split spatially, and is not clipped.
    #[inline]
    pub(crate) fn settled(&self, cut: &Cut, arena: &[Node]) -> Option<Node> {
        if !(self.rules.opens_once && cut.len == 1 && cut.stage == Stage::Nodes && cut.kind != Kind::Leaf) {
            return None;
        }
        let node = arena[cut.places().start];
        let is_settled = !node.is_leaf()
            && cut.count > self.rules.leaf_sweep
            && cut.depth < MAX_DEPTH
            && !self.splits_in_space(cut)
            && is_whole(&node, &cut.clip);
        is_settled.then_some(node)
    }

    /// The children of such a cut.
    pub(crate) fn split_settled(&self, cut: &Cut, node: &Node, scratch: &mut Scratch) -> [Option<Cut>; 2] {
        let (known, at) = (self.known(), At { node: *node, first: 0 });
        if cut.kind == Kind::Inner && known.kind(&at, self.rules.max_leaf) == Kind::SoftLeaf {
            return [Some(Cut { kind: Kind::SoftLeaf, ..*cut }), None];
        }
        scratch.counts.splits += 1;
        scratch.counts.swept += 2;
        known.children(&at).map(|At { node: child, .. }| {
            scratch.arena.push(child);
            self.tree.prefetch(&child);
            Some(Cut {
                first: scratch.arena.len() as u32 - 1,
                bounds: child.bounds(),
                area: child.bounds().half_area(),
                count: child.count(),
                capacity: child.count(),
                depth: cut.depth + 1,
                kind: if child.count() <= QUARTET { Kind::Leaf } else { Kind::Inner },
                ..*cut
            })
        })
    }

    /// The wide nodes below such a cut, if nothing else is to be done for the parts of it either; `None`, and nothing
    /// appended, if that makes the tree too deep.
    pub(crate) fn finish_settled(
        &self,
        cut: &Cut,
        node: &Node,
        piece: &mut Piece,
        counts: &mut Counts,
    ) -> Option<Subtree> {
        let Rules { leaf_sweep, subtree_sweep, auxiliary_leaf, max_leaf, .. } = self.rules;
        if leaf_sweep.max(subtree_sweep).max(auxiliary_leaf) > QUARTET {
            return None;
        }
        let leaves = Leaves::of(&self.order.references, max_leaf);
        let (mark, known) = (piece.mark(), self.known());
        let at = At { node: *node, first: self.tree.run(node).start as u32 };
        let kind = if cut.kind == Kind::Inner { known.kind(&at, max_leaf) } else { cut.kind };
        let mut splits = 0;
        let subtree = known.wide(&at, kind, MAX_DEPTH - cut.depth, &leaves, piece, &mut splits);
        if subtree.is_none() {
            piece.release(mark);
            return None;
        }
        counts.splits += splits;
        counts.swept += 2 * splits;
        subtree
    }
}
