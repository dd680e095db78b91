//! Where the recursion over cuts ends: small cuts swept down to their leaves in one go, and what leaves hold.

use super::binary::Node;
use super::cut::{Cut, Stage, is_whole};
use super::cut_recursion::{CutRecursion, Scratch};
use super::rules::Refine;
use super::subtrees::Subtrees;
use super::top_down::Kind;
use crate::geometry::Aabb;

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
    pub(super) fn children_swept(&self, cut: &Cut, node: Node, scratch: &mut Scratch) -> [Option<Cut>; 2] {
        let Scratch { arena, subtrees, .. } = scratch;
        subtrees.children(&node).map(|child| self.swept(cut, child, subtrees, arena))
    }

    /// Splits a cut of few references down to its leaves.
    pub(super) fn sweep_subtree(&self, cut: &Cut, scratch: &mut Scratch) -> [Option<Cut>; 2] {
        let Some(node) = self.subtree(cut, scratch) else { return [None, None] };
        let Scratch { arena, subtrees, .. } = scratch;
        match subtrees.kind(&node, self.rules.max_leaf) {
            Kind::Inner => self.children_swept(cut, node, scratch),
            Kind::SoftLeaf | Kind::Leaf => [self.swept(cut, node, subtrees, arena), None],
        }
    }

    /// The subtree of few references, by sweeps.
    pub(super) fn subtree(&self, cut: &Cut, scratch: &mut Scratch) -> Option<Node> {
        let Scratch { arena, subtree_sweep, subtrees, .. } = scratch;
        subtree_sweep.clear();
        for node in &arena[cut.places()] {
            self.order.each(self.tree, node, &cut.clip, &mut |reference| {
                subtree_sweep.push(reference.bounds(), self.order.prim(reference.run().start));
            });
        }
        subtree_sweep.build(self.isa, subtrees)
    }

    /// Appends the triangles of a leaf; returns their box. Of a triangle that is not wholly inside the clip box
    /// `seen` tells what the leaf sees, given the box of its part.
    pub(super) fn gather(
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
                prims.extend(scratch.subtrees.prims(node));
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
