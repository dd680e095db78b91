//! Parts of the tree that fit a cache, made wide as it is cheapest: they are split down to quartets first, and dynamic
//! programming then chooses nodes and leaves ([`crate::builders::optimise`]).

use crate::builders::binary::Node;
use crate::builders::binary::subtrees::Subtrees;
use crate::builders::optimise::Costs;
use crate::builders::optimise::choices::{Choice, Solved};
use crate::builders::phr::cut::{Cut, Stage};
use crate::builders::phr::policy::Refine;
use crate::builders::phr::recursion::{CutRecursion, Scratch};
use crate::builders::wide::largest_first::{At, KnownSplits, Leaves};
use crate::builders::wide::top_down::{Kind, TopDown, WIDTH};
use crate::builders::wide::treelet::{Piece, Subtree};
use crate::bvh::Link;
use crate::geometry::Aabb;
use arrayvec::ArrayVec;

/// Memory for one part at a time.
#[derive(Default)]
pub(crate) struct Cheapest {
    /// What was chosen for the parent of each pair.
    choices: Vec<Choice>,
    /// Triangles of a leaf.
    prims: Vec<u32>,
}

impl<R: Refine> CutRecursion<'_, R> {
    /// Appends the cheapest wide nodes and blocks of a part.
    pub(crate) fn collapse(
        &self,
        part: &Cut,
        costs: &Costs,
        piece: &mut Piece,
        scratch: &mut Scratch,
    ) -> Subtree {
        let root = self.drawn(part, scratch)?;
        let Scratch { subtrees, cheapest, .. } = scratch;
        cheapest.choices.resize(subtrees.pairs.len(), Choice::NONE);
        solve(&root, subtrees, costs, &mut cheapest.choices);
        let mut leaves = Leaves::of(&self.order.references, costs.max_leaf);
        // Spatial splits may have parted what comes together again.
        leaves.may_repeat |= self.splits_in_space(part);
        wide(&subtrees.at(&root), &cheapest.choices, subtrees, &leaves, piece)
    }

    /// The binary tree over a part; `None` if clipping left nothing of it.
    fn drawn(&self, part: &Cut, scratch: &mut Scratch) -> Option<Node> {
        if part.stage == Stage::Swept {
            return Some(scratch.arena[part.places().start]);
        }
        if part.kind != Kind::Inner {
            return self.drawn_leaf(part, scratch);
        }
        if let Some(subtree) = self.sweep_subtree(part, scratch) {
            return subtree;
        }
        let mark = scratch.arena.len();
        let sides = self.split(part, scratch);
        let halves = sides.map(|side| side.and_then(|side| self.drawn(&side, scratch)));
        scratch.arena.truncate(mark);
        match halves {
            [Some(left), Some(right)] => {
                let pair = [left, right];
                scratch.subtrees.pairs.push(pair);
                Some(Node::inner(&pair, scratch.subtrees.pairs.len() - 1))
            }
            [only, None] | [None, only] => only,
        }
    }

    fn drawn_leaf(&self, part: &Cut, scratch: &mut Scratch) -> Option<Node> {
        let mut prims = std::mem::take(&mut scratch.cheapest.prims);
        prims.clear();
        let bounds = self.leaf(part, &mut prims, scratch);
        let first = scratch.subtrees.prims.len();
        scratch.subtrees.prims.extend_from_slice(&prims);
        let leaf = (!prims.is_empty()).then(|| Node::leaf(bounds, first, prims.len() as u32));
        scratch.cheapest.prims = prims;
        leaf
    }
}

fn solve(node: &Node, subtrees: &Subtrees, costs: &Costs, choices: &mut [Choice]) -> Solved {
    let area = node.bounds().half_area();
    let Some(pair) = node.pair() else { return costs.block(area, node.count()) };
    let [left, right] = &subtrees.pairs[pair];
    let (left, right) = (solve(left, subtrees, costs, choices), solve(right, subtrees, costs, choices));
    let (solved, choice) = costs.over(area, &left, &right);
    choices[pair] = choice;
    solved
}

/// Appends the nodes and blocks that were chosen for a subtree.
fn wide(at: &At, choices: &[Choice], subtrees: &Subtrees, leaves: &Leaves<'_>, piece: &mut Piece) -> Subtree {
    if at.node.pair().is_none_or(|pair| choices[pair].is_leaf()) {
        return subtrees.leaf(at, leaves, piece).map(|link| (at.node.bounds(), link));
    }
    let mut children = ArrayVec::<At, WIDTH>::new();
    open(at, WIDTH, choices, subtrees, &mut children);
    let built: ArrayVec<(Aabb, Link), WIDTH> =
        children.iter().filter_map(|child| wide(child, choices, subtrees, leaves, piece)).collect();
    piece.node(&built)
}

/// Opens a subtree into up to `slots` children.
fn open(at: &At, slots: usize, choices: &[Choice], subtrees: &Subtrees, children: &mut ArrayVec<At, WIDTH>) {
    match at.node.pair() {
        Some(pair) if slots > 1 => match choices[pair].left(slots) {
            0 => open(at, slots - 1, choices, subtrees, children),
            of_left => {
                let [left, right] = KnownSplits::children(subtrees, at);
                open(&left, of_left, choices, subtrees, children);
                open(&right, slots - of_left, choices, subtrees, children);
            }
        },
        _ => children.push(*at),
    }
}
