//! Reinsertion: subtrees move to where they enlarge the tree least (Bittner, Hapala, Havran 2013).
//!
//! As by Meister and Bittner (2018) all candidates of a round search the same tree in parallel. The moves found are
//! then made one after another, the best first, each only if by then it still makes the tree smaller: no round
//! raises the cost, and the tree does not depend on the number of threads.

use super::candidates::Candidates;
use super::tree::{LinkedNode, Pair, ROOT, Tree};
use crate::bvh::MAX_DEPTH;
use crate::geometry::Aabb;
use crate::memory::huge_pages;
use crate::parallel;
use rayon::prelude::*;

/// Searches per task.
const CHUNK: usize = 256;
/// Pairs that a search looks into. Bounds tell nothing where many boxes hold the subtree's and none is a better place:
/// each search would look at every node.
const MOST_LOOKS: usize = 1 << 12;

/// A better place for a subtree.
#[derive(Clone, Copy, Debug, Default)]
struct Move {
    /// By how much the areas of inner nodes shrink.
    gain: f32,
    /// The subtree.
    node: u32,
    /// Its sibling to be.
    target: u32,
}

/// Rounds of reinsertion, and their memory.
#[derive(Default)]
pub(crate) struct Reinsertion {
    candidates: Candidates,
    moves: Vec<Move>,
    /// Nodes that looked in vain since they were placed.
    tried: Vec<bool>,
    /// Nodes that were replaced by others in this round.
    replaced: Vec<bool>,
}

impl Reinsertion {
    /// Does `rounds` rounds for the `wanted` most promising nodes each.
    pub fn run(&mut self, tree: &mut Tree, rounds: u32, wanted: usize) {
        self.tried.clear();
        huge_pages::resize(&mut self.tried, 2 * tree.pairs.len(), false, "nodes that were tried");
        for _ in 0..rounds {
            self.round(tree, wanted);
        }
    }

    /// One round.
    pub(super) fn round(&mut self, tree: &mut Tree, wanted: usize) {
        self.candidates.find(tree, &self.tried, wanted);
        let nodes = &self.candidates.nodes;
        huge_pages::resize(&mut self.moves, nodes.len(), Move::default(), "moves of nodes");
        let chunks = self.moves.chunks_mut(CHUNK).zip(nodes.chunks(CHUNK));
        parallel::for_each(chunks, |(moves, nodes)| {
            let mut stack = Vec::new();
            for (to, &node) in moves.iter_mut().zip(nodes) {
                *to = tree.search(node, &mut stack);
            }
        });
        let tried = &mut self.tried;
        self.moves.retain(|one| {
            tried[one.node as usize] = one.gain == 0.0;
            one.gain > 0.0
        });
        self.moves.par_sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.node.cmp(&b.node)));
        // A search holds no longer where the nodes it speaks of were replaced.
        self.replaced.clear();
        huge_pages::resize(&mut self.replaced, 2 * tree.pairs.len(), false, "nodes that were replaced");
        for &one in &self.moves {
            if self.replaced[one.node as usize] || self.replaced[one.target as usize] {
                continue;
            }
            if let Some(places) = tree.make(one) {
                for index in places {
                    self.replaced[index as usize] = true;
                    self.tried[index as usize] = false;
                }
            }
        }
    }
}

impl Tree {
    /// The best place for node `index`, of gain 0 if none is better than its own, by branch and bound: first below
    /// its sibling, then level by level up, beside and below the siblings of its ancestors, until [`MOST_LOOKS`].
    ///
    /// On the way down `saved` is the area gained by removing the subtree, less the growth of the nodes above the
    /// place so far. The new node there costs at least the subtree's own area.
    fn search(&self, index: u32, stack: &mut Vec<(f32, u32)>) -> Move {
        let bounds = self.node(index).bounds();
        let own = bounds.half_area();
        let parent = self.parent(index);
        let mut best = Move { gain: 0.0, node: index, target: index };
        // The ancestor up to which there was a search, its area, and its box without the subtree.
        let (mut pivot, mut sibling) = (parent, index ^ 1);
        let mut pivot_area = self.node(parent).half_area();
        let mut without = self.node(sibling).bounds();
        let mut saved = pivot_area;
        if let Some(pair) = self.node(sibling).pair() {
            let grown = without.union(bounds).half_area() - without.half_area();
            stack.push((saved - grown, pair as u32));
        }
        let mut looks = 0;
        loop {
            while let Some((saved, pair)) = stack.pop() {
                if saved - own > best.gain {
                    looks += 1;
                    if looks > MOST_LOOKS {
                        stack.clear();
                        return best;
                    }
                    let Pair(children) = &self.pairs[pair as usize];
                    for (half, child) in children.iter().enumerate() {
                        consider(child, 2 * pair + half as u32, saved, bounds, own, &mut best, stack);
                    }
                }
            }
            if pivot == ROOT {
                break;
            }
            if pivot != parent {
                without = without.union(self.node(sibling).bounds());
                saved += pivot_area - without.half_area();
                // Beside the ancestor itself: the new node takes its old box.
                if saved - pivot_area > best.gain {
                    best = Move { gain: saved - pivot_area, target: pivot, ..best };
                }
            }
            sibling = pivot ^ 1;
            pivot = self.parent(pivot);
            pivot_area = self.node(pivot).half_area();
            consider(self.node(sibling), sibling, saved, bounds, own, &mut best, stack);
        }
        best
    }

    /// Makes a move if it still is one; returns the places that hold another node than before.
    fn make(&mut self, Move { node: index, target, .. }: Move) -> Option<[u32; 4]> {
        let parent = self.parent(index);
        if parent == ROOT || target == parent || target == index ^ 1 || !self.is_allowed(index, target) {
            return None;
        }
        let pair = index / 2;
        let (node, sibling) = (*self.node(index), *self.node(index ^ 1));
        let mut saved = self.node(parent).half_area();
        self.place(parent, sibling);
        saved += self.fit_above(parent);
        // Where it no longer pays the subtree goes back to its sibling.
        let target = if self.growth(target, node.bounds()) < saved { target } else { parent };
        self.place(2 * pair, *self.node(target));
        self.place(2 * pair + 1, node);
        self.place(target, LinkedNode::inner(&self.pairs[pair as usize], pair as usize));
        self.fit_above(target);
        Some([2 * pair, 2 * pair + 1, parent, target])
    }

    /// Whether `target` is not below node `index`, and not so deep that traversal stacks could overflow.
    fn is_allowed(&self, index: u32, target: u32) -> bool {
        let mut levels = 1 + self.node(index).height().max(self.node(target).height());
        let mut at = target;
        while at != ROOT {
            if at == index {
                return false;
            }
            at = self.parent(at);
            levels += 1;
        }
        levels <= MAX_DEPTH as u32
    }

    /// What the areas of inner nodes grow by if a subtree of box `bounds` becomes the sibling of `target`.
    fn growth(&self, target: u32, bounds: Aabb) -> f32 {
        let mut growth = self.node(target).bounds().union(bounds).half_area();
        let mut at = target;
        while at != ROOT {
            at = self.parent(at);
            let above = self.node(at).bounds();
            if above.contains(bounds) {
                break;
            }
            growth += above.union(bounds).half_area() - above.half_area();
        }
        growth
    }

    /// Fits the nodes above `index`; returns what their areas shrink by.
    fn fit_above(&mut self, index: u32) -> f32 {
        let mut shrunk = 0.0;
        let mut at = index;
        while at != ROOT {
            at = self.parent(at);
            let (old, new) = (*self.node(at), self.fitted(at));
            if new.bounds() == old.bounds() && new.height() == old.height() {
                break;
            }
            shrunk += old.half_area() - new.half_area();
            self.place(at, new);
        }
        shrunk
    }
}

/// Looks at `place` as the sibling of a subtree of box `bounds` and area `own`, and whether to look below it.
#[inline(always)]
fn consider(
    node: &LinkedNode,
    place: u32,
    saved: f32,
    bounds: Aabb,
    own: f32,
    best: &mut Move,
    stack: &mut Vec<(f32, u32)>,
) {
    let gain = saved - node.bounds().union(bounds).half_area();
    if gain > best.gain {
        *best = Move { gain, target: place, ..*best };
    }
    if let Some(pair) = node.pair() {
        let below = gain + node.half_area();
        if below - own > best.gain {
            stack.push((below, pair as u32));
        }
    }
}
