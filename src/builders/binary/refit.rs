//! Refitting a binary tree to references that have moved: boxes are made anew bottom-up, the topology stays.

use super::node::Node;
use super::tree::{BinaryTree, MOST_DIVIDED_LEVELS, TREELET};
use crate::geometry::Aabb;
use crate::parallel;
use std::ops::Range;

impl BinaryTree {
    /// Makes all boxes anew, where `leaf` gives the box of a run of references. In the array of pairs children
    /// stand before parents, and the pairs of subtrees of up to [`TREELET`] references, or [`MOST_DIVIDED_LEVELS`]
    /// below the root, in rows, one after the other.
    pub fn refit(&mut self, leaf: impl Fn(Range<usize>) -> Aabb + Sync) {
        let Some(root) = self.root else { return };
        let mut ends = Vec::new();
        self.rows(&root, 0, &mut ends);
        let (mut rows, mut rest, mut first) = (Vec::new(), &mut self.pairs[..], 0);
        for end in ends {
            let (row, others) = rest.split_at_mut(end - first);
            rows.push((first, row));
            (rest, first) = (others, end);
        }
        parallel::for_each(rows, |(first, row)| refit_pairs(row, first, 0..row.len(), &leaf));
        // What is above the rows, one pair for thousands of references.
        let top = first..self.pairs.len();
        refit_pairs(&mut self.pairs, 0, top, &leaf);
        self.root = Some(refitted(&root, &self.pairs, 0, &leaf));
    }

    /// Where the rows below `node`, so many levels below the root, end.
    fn rows(&self, node: &Node, level: u32, ends: &mut Vec<usize>) {
        match node.pair() {
            None => {}
            Some(pair) if node.count() <= TREELET as u32 || level == MOST_DIVIDED_LEVELS => {
                ends.push(pair + 1)
            }
            Some(_) => self.children(node).iter().for_each(|child| self.rows(child, level + 1, ends)),
        }
    }
}

/// Refits some of `pairs`, the first of which is pair `first` of the tree.
fn refit_pairs(
    pairs: &mut [[Node; 2]],
    first: usize,
    some: Range<usize>,
    leaf: &impl Fn(Range<usize>) -> Aabb,
) {
    for pair in some {
        pairs[pair] = pairs[pair].map(|child| refitted(&child, pairs, first, leaf));
    }
}

/// The node with its new box; the pairs below it are refitted.
fn refitted(node: &Node, pairs: &[[Node; 2]], first: usize, leaf: &impl Fn(Range<usize>) -> Aabb) -> Node {
    let bounds = match node.pair() {
        None => leaf(node.run()),
        Some(pair) => {
            let [left, right] = &pairs[pair - first];
            left.bounds().union(right.bounds())
        }
    };
    node.with_bounds(bounds)
}
