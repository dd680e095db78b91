//! Cuts that are split down to their leaves in one go: cuts of leaves, to the same tree ([`super::exact::leaf_cuts`]),
//! and small cuts, to another ([`super::extensions::small_cuts`]). The recursion goes on along the binary splits found.

use super::cut::{Cut, CutLevel};
use super::memory::CutScratch;
use super::policy::CutPolicy;
use super::recursion::CutRecursion;
use crate::builders::binary::kind::Kind;
use crate::builders::binary::node::Node;
use crate::builders::binary::subtrees::Subtrees;
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::binary_source::{BinarySource, Leaves};
use crate::builders::wide::treelet::{WideRoot, WideTreelet};

impl<P: CutPolicy, G: Geometry> CutRecursion<'_, P, G> {
    /// The subtree of a cut that is split down to its leaves in one go, nothing if clipping left nothing; `None`
    /// for other cuts.
    pub(super) fn split_down(&self, cut: &Cut, scratch: &mut CutScratch) -> Option<Option<Node>> {
        if self.splits_in_space(cut) || cut.level == CutLevel::SplitDown {
            None
        } else if self.is_small(cut) {
            Some(self.split_down_small_cut(cut, scratch))
        } else if self.is_of_leaves(cut) {
            Some(Some(self.split_down_leaf_cut(cut, scratch)))
        } else {
            None
        }
    }

    /// The sides of a cut that is, or has been, split down to its leaves in one go; `None` for other cuts.
    pub(super) fn split_down_sides(&self, cut: &Cut, scratch: &mut CutScratch) -> Option<[Option<Cut>; 2]> {
        if cut.level == CutLevel::SplitDown {
            return Some(self.parts_below(cut, scratch.arena[cut.range().start], scratch));
        }
        let Some(node) = self.split_down(cut, scratch)? else { return Some([None, None]) };
        let CutScratch { arena, subtrees, .. } = scratch;
        Some(match self.kind_of(&node, subtrees) {
            Kind::Inner => self.parts_below(cut, node, scratch),
            Kind::SoftLeaf | Kind::Leaf => [Some(self.part_below(cut, node, subtrees, arena)), None],
        })
    }

    /// Appends the wide nodes of such a cut; `None` for others.
    pub(super) fn emit_split_down<const N: usize>(
        &self,
        cut: &Cut,
        treelet: &mut WideTreelet<N, G::Block>,
        scratch: &mut CutScratch,
    ) -> Option<WideRoot> {
        if cut.level == CutLevel::SplitDown {
            let node = scratch.arena[cut.range().start];
            return Some(self.emit_subtree(&node, cut.kind, &scratch.subtrees, treelet));
        }
        if cut.kind != Kind::Inner {
            return None;
        }
        let checkpoint = scratch.subtrees.checkpoint();
        let subtree = self.split_down(cut, scratch)?.and_then(|node| {
            let subtrees = &scratch.subtrees;
            self.emit_subtree(&node, self.kind_of(&node, subtrees), subtrees, treelet)
        });
        scratch.subtrees.rollback(checkpoint);
        Some(subtree)
    }

    fn emit_subtree<const N: usize>(
        &self,
        node: &Node,
        kind: Kind,
        subtrees: &Subtrees,
        treelet: &mut WideTreelet<N, G::Block>,
    ) -> WideRoot {
        let leaves = Leaves::of(&self.order.refs, self.config.leaf_size());
        subtrees
            .emit((&subtrees.run_of(node), kind), u32::MAX, &leaves, treelet, &mut 0)
            .expect("a subtree has fewer levels")
    }

    fn kind_of(&self, node: &Node, subtrees: &Subtrees) -> Kind {
        Kind::of(node, self.config.leaf_size(), || subtrees.children(node))
    }

    /// The subtree of `node` as a part of the recursion.
    fn part_below(&self, like: &Cut, node: Node, subtrees: &Subtrees, arena: &mut Vec<Node>) -> Cut {
        arena.push(node);
        like.of_last(arena, CutLevel::SplitDown, self.kind_of(&node, subtrees))
    }

    fn parts_below(&self, cut: &Cut, node: Node, scratch: &mut CutScratch) -> [Option<Cut>; 2] {
        let CutScratch { arena, subtrees, .. } = scratch;
        subtrees.children(&node).map(|child| Some(self.part_below(cut, child, subtrees, arena)))
    }
}
