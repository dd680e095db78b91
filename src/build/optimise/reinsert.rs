//! Reinsertion: subtrees move to where they enlarge the tree least (Bittner, Hapala, Havran 2013).
//!
//! As by Meister and Bittner (2018) all candidates of a round search the same tree in parallel. The moves found are
//! then made one after another, the best first, each only if by then it still makes the tree smaller: no round
//! raises the cost, and the tree does not depend on the number of threads.

use super::tree::{Node, Pair, ROOT, Tree};
use crate::bvh::MAX_DEPTH;
use crate::geometry::Aabb;
use rayon::prelude::*;

/// Searches per task.
const CHUNK: usize = 256;

/// A better place for a subtree.
#[derive(Clone, Copy, Debug)]
struct Move {
    /// By how much the areas of inner nodes shrink.
    gain: f32,
    /// The subtree.
    node: u32,
    /// Its sibling to be.
    target: u32,
}

impl Tree {
    /// One round for the `wanted` most promising nodes; returns how many moved.
    pub fn reinsert(&mut self, wanted: usize) -> usize {
        let candidates = self.candidates(wanted);
        let mut moves: Vec<Move> = candidates
            .par_chunks(CHUNK)
            .flat_map_iter(|chunk| {
                let mut stack = Vec::new();
                chunk.iter().filter_map(|&node| self.search(node, &mut stack)).collect::<Vec<_>>()
            })
            .collect();
        moves.par_sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.node.cmp(&b.node)));
        // A search holds no longer where the nodes it speaks of were replaced.
        let mut replaced = vec![false; 2 * self.pairs.len()];
        let mut made = 0;
        for one in moves {
            if replaced[one.node as usize] || replaced[one.target as usize] {
                continue;
            }
            if let Some(places) = self.make(one) {
                places.iter().for_each(|&index| replaced[index as usize] = true);
                made += 1;
            }
        }
        made
    }

    /// The best place for node `index`, if it is better than its own, by branch and bound: first below its sibling,
    /// then level by level up, beside and below the siblings of its ancestors.
    ///
    /// On the way down `saved` is what the areas of inner nodes have shrunk by without the subtree, less what
    /// the nodes above the place have grown by with it: there a new node is to be paid of no less than its own area.
    fn search(&self, index: u32, stack: &mut Vec<(f32, u32)>) -> Option<Move> {
        let bounds = self.node(index).bounds();
        let own = bounds.half_area();
        let parent = self.parent(index);
        let mut best = Move { gain: 0.0, node: index, target: index };
        // The ancestor up to which there was a search, its area, and its box without the subtree.
        let (mut pivot, mut sibling) = (parent, index ^ 1);
        let mut pivot_area = self.node(parent).half_area();
        let mut without = self.node(sibling).bounds();
        let mut saved = pivot_area;
        if let Some(pair) = self.node(sibling).open_pair() {
            let grown = without.union(bounds).half_area() - without.half_area();
            stack.push((saved - grown, pair as u32));
        }
        loop {
            while let Some((saved, pair)) = stack.pop() {
                if saved - own > best.gain {
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
        (best.target != index).then_some(best)
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
        self.place(target, Node::inner(&self.pairs[pair as usize], pair as usize));
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
    node: &Node,
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
    if let Some(pair) = node.open_pair() {
        let below = gain + node.half_area();
        if below - own > best.gain {
            stack.push((below, pair as u32));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::soup;
    use super::*;
    use crate::build::{Builder, Lbvh};

    /// The sum of the areas of inner nodes.
    fn cost(tree: &Tree, index: u32) -> f64 {
        let node = tree.node(index);
        let below = |pair: usize| [0, 1].map(|half| cost(tree, 2 * pair as u32 + half)).iter().sum::<f64>();
        node.pair().map_or(0.0, |pair| f64::from(node.half_area()) + below(pair))
    }

    #[test]
    fn no_round_raises_the_cost_and_together_they_lower_it() {
        let mesh = soup(4000);
        let mut tree = Tree::default();
        tree.unfold(&Lbvh::default().build(&mesh).tree, &mesh);
        let mut costs = vec![cost(&tree, ROOT)];
        for _ in 0..5 {
            tree.reinsert(tree.pairs.len() / 4);
            costs.push(cost(&tree, ROOT));
        }
        assert!(costs.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-6)), "{costs:?}");
        assert!(costs[5] < 0.995 * costs[0], "{costs:?}");
    }

    #[test]
    fn boxes_heights_and_parents_stay_right() {
        let mesh = soup(1000);
        let mut tree = Tree::default();
        tree.unfold(&Lbvh::default().build(&mesh).tree, &mesh);
        tree.reinsert(tree.pairs.len());
        let mut open = vec![ROOT];
        let mut references = 0;
        while let Some(index) = open.pop() {
            let (node, fitted) = (tree.node(index), tree.fitted(index));
            assert_eq!((node.bounds(), node.height()), (fitted.bounds(), fitted.height()));
            match node.pair() {
                Some(pair) => {
                    assert_eq!(tree.parent(2 * pair as u32), index);
                    open.extend([2 * pair as u32, 2 * pair as u32 + 1]);
                }
                None => references += 1,
            }
        }
        assert_eq!(references, mesh.len());
    }
}
