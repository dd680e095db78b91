//! Where the recursion over cuts ends: small cuts swept down to their leaves in one go, and what leaves hold.

use crate::builders::binary::Node;
use crate::builders::binary::subtrees::Subtrees;
use crate::builders::phr::cut::{Cut, Stage, is_inside, is_whole};
use crate::builders::phr::policy::Refine;
use crate::builders::phr::recursion::{CutRecursion, MAX_DEPTH, Scratch};
use crate::builders::split::sweep_sah;
use crate::builders::wide::largest_first::{KnownSplits, Leaves};
use crate::builders::wide::top_down::{Kind, QUARTET};
use crate::builders::wide::treelet::{Piece, Subtree};
use crate::geometry::Aabb;

/// Fewest leaves of a cut that is split in one go: shorter ones are split faster one by one.
const FEWEST: usize = 9;

impl<R: Refine> CutRecursion<'_, R> {
    /// The subtree of `node` as a part of the recursion.
    fn swept(&self, like: &Cut, node: Node, subtrees: &Subtrees, arena: &mut Vec<Node>) -> Option<Cut> {
        arena.push(node);
        Some(Cut {
            first: arena.len() as u32 - 1,
            len: 1,
            bounds: node.bounds(),
            area: node.bounds().half_area(),
            count: node.count(),
            stage: Stage::Swept,
            kind: subtrees.kind(&node, self.rules.max_leaf),
            ..*like
        })
    }

    /// The children of a swept subtree.
    pub(crate) fn children_swept(&self, cut: &Cut, node: Node, scratch: &mut Scratch) -> [Option<Cut>; 2] {
        let Scratch { arena, subtrees, .. } = scratch;
        subtrees.children(&node).map(|child| self.swept(cut, child, subtrees, arena))
    }

    /// The subtree, nothing if clipping left nothing, of a cut that is split down to its leaves in one go; `None` for
    /// other cuts. Such are cuts of few references by the rules, or, without such rules, cuts of leaves alone, of which
    /// there is nothing to refine.
    pub(crate) fn sweep_subtree(&self, cut: &Cut, scratch: &mut Scratch) -> Option<Option<Node>> {
        if self.splits_in_space(cut) || cut.stage == Stage::Swept {
            return None;
        }
        let Scratch { arena, subtree_sweep, subtrees, counts, .. } = scratch;
        let nodes = &arena[cut.places()];
        if cut.count <= self.rules.subtree_sweep {
            subtree_sweep.clear();
            for node in nodes {
                self.order.each(self.tree, node, &cut.clip, &mut |reference| {
                    subtree_sweep.push(reference.bounds(), self.order.prim(reference.run().start));
                });
            }
            return Some(subtree_sweep.build(self.isa, subtrees));
        }
        self.is_of_leaves(cut).then(|| {
            subtree_sweep.clear();
            for node in nodes {
                subtree_sweep.push(node.bounds(), self.order.prim(node.run().start));
            }
            let pairs = subtrees.pairs.len();
            let root = subtree_sweep.build_as_cut(self.isa, MAX_DEPTH - cut.depth, subtrees);
            counts.splits += (subtrees.pairs.len() - pairs) as u64;
            counts.swept +=
                subtrees.pairs[pairs..].iter().flatten().map(|node| u64::from(node.count())).sum::<u64>();
            Some(root)
        })
    }

    /// Whether a cut is of leaves alone, and no rule of ours is for what is near the leaves.
    fn is_of_leaves(&self, cut: &Cut) -> bool {
        // What is clipped is seen otherwise by leaves, and where parts of a triangle meet they are counted as one for the
        // cheapest wide tree.
        let may_repeat = !self.order.references.fragments.is_empty();
        cut.count == cut.len
            && !(may_repeat && self.rules.collapse.is_some())
            && cut.stage == Stage::Nodes
            && self.rules.leaf_sweep.max(self.rules.subtree_sweep) <= QUARTET
            && (FEWEST..=sweep_sah::MOST).contains(&(cut.len as usize))
            && cut.depth < MAX_DEPTH
            && is_inside(cut.bounds, &cut.clip)
    }

    /// The parts of a cut that is split down to its leaves in one go; `None` for other cuts.
    pub(crate) fn split_subtree(&self, cut: &Cut, scratch: &mut Scratch) -> Option<[Option<Cut>; 2]> {
        let Some(node) = self.sweep_subtree(cut, scratch)? else { return Some([None, None]) };
        let Scratch { arena, subtrees, .. } = scratch;
        Some(match subtrees.kind(&node, self.rules.max_leaf) {
            Kind::Inner => self.children_swept(cut, node, scratch),
            Kind::SoftLeaf | Kind::Leaf => [self.swept(cut, node, subtrees, arena), None],
        })
    }

    /// The wide nodes of a cut that is split down to its leaves in one go; `None` for other cuts.
    pub(crate) fn finish_subtree(
        &self,
        cut: &Cut,
        piece: &mut Piece,
        scratch: &mut Scratch,
    ) -> Option<Subtree> {
        if cut.kind != Kind::Inner {
            return None;
        }
        let mark = scratch.subtrees.mark();
        let subtree = match self.sweep_subtree(cut, scratch)? {
            None => None,
            Some(node) => {
                self.wide(&node, scratch.subtrees.kind(&node, self.rules.max_leaf), &scratch.subtrees, piece)
            }
        };
        scratch.subtrees.release(mark);
        Some(subtree)
    }

    /// The wide nodes of a swept subtree.
    pub(crate) fn wide(&self, node: &Node, kind: Kind, subtrees: &Subtrees, piece: &mut Piece) -> Subtree {
        let leaves = Leaves::of(&self.order.references, self.rules.max_leaf);
        subtrees
            .wide(&subtrees.at(node), kind, u32::MAX, &leaves, piece, &mut 0)
            .expect("there are not so many levels")
    }

    /// Appends the triangles of a leaf; returns their box. Of a triangle that is not wholly inside the clip box
    /// `seen` tells what the leaf sees, given the box of its part.
    pub(crate) fn gather(
        &self,
        cut: &Cut,
        prims: &mut Vec<u32>,
        scratch: &Scratch,
        seen: impl Fn(u32, Aabb) -> Option<Aabb>,
    ) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        for node in &scratch.arena[cut.places()] {
            if cut.stage == Stage::Swept {
                bounds = node.bounds();
                prims.extend(scratch.subtrees.run(node));
            } else if is_whole(node, &cut.clip) {
                bounds = bounds.union(node.bounds());
                prims.extend(self.tree.run(node).map(|place| self.order.prim(place)));
            } else {
                self.order.each(self.tree, node, &cut.clip, &mut |reference| {
                    let prim = self.order.prim(reference.run().start);
                    if let Some(part) = seen(prim, reference.bounds()) {
                        bounds = bounds.union(part);
                        prims.push(prim);
                    }
                });
            }
        }
        if !self.order.references.fragments.is_empty() {
            // Parts of one triangle may meet in a leaf.
            prims.sort_unstable();
            prims.dedup();
        }
        bounds
    }
}
