//! Full leaves of `lbvh` and of finished clusters: a subtree of up to 16 references has as few blocks as hold them.

use super::auxiliary::{Item, Tree, partitioned};
use crate::bvh::limits::MIDDLE_DEPTH;
use std::rc::Rc;

/// Most references of a subtree with full leaves.
const FULL: usize = 16;
/// Most references of a leaf.
const LEAF: usize = 4;

/// The subtree over a run of sorted codes that has been partitioned `depth` times by the middle.
pub fn with_full_leaves(run: &[Item], depth: u32) -> Rc<Tree> {
    if run.len() <= FULL {
        let mut neighbours = Vec::new();
        in_order(run, depth, 0, &mut neighbours);
        return separated(&neighbours);
    }
    let ([left, right], depth) = partitioned(run, depth);
    Tree::node(with_full_leaves(&left, depth), with_full_leaves(&right, depth))
}

/// A reference, and how high the radix tree separates it from the one before.
type Neighbour = (u32, Item);

/// Appends the run in the order of the radix tree.
fn in_order(run: &[Item], depth: u32, height: u32, neighbours: &mut Vec<Neighbour>) {
    if run.len() <= LEAF {
        let inner = run.windows(2).map(|pair| height_of(pair[0], pair[1], None));
        neighbours.extend([height].into_iter().chain(inner).zip(run.iter().copied()));
        return;
    }
    let ([left, right], below) = partitioned(run, depth);
    let between = height_of(left[0], right[0], Some(depth));
    in_order(&left, below, height, neighbours);
    in_order(&right, below, between, neighbours);
}

/// That of two neighbours, by their codes; else by how often the middle was taken before, if it divides them.
fn height_of((before, _): Item, (after, _): Item, depth: Option<u32>) -> u32 {
    // More than halvings of a run of one code.
    const HALVINGS: u32 = MIDDLE_DEPTH + u32::BITS;
    match before ^ after {
        0 => depth.map_or(0, |depth| HALVINGS - depth),
        difference => HALVINGS + 1 + difference.ilog2(),
    }
}

/// The tree over neighbours that has no more blocks than hold them: divided where they are separated highest, among the
/// places that need no extra block; the first of equals.
fn separated(neighbours: &[Neighbour]) -> Rc<Tree> {
    let len = neighbours.len();
    if len <= LEAF {
        return Tree::leaf(&neighbours.iter().map(|(_, (_, reference))| *reference).collect::<Vec<_>>());
    }
    let blocks = |references: usize| references.div_ceil(LEAF);
    let places = (1..len).filter(|&left| blocks(left) + blocks(len - left) == blocks(len));
    let place =
        places.rev().max_by_key(|&left| neighbours[left].0).expect("more than a block can be divided");
    let (left, right) = neighbours.split_at(place);
    Tree::node(separated(left), separated(right))
}
