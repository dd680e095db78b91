//! Paper 4.1: the initial cut. From the root on, the largest node is opened, until none is larger than a threshold or
//! the cut is long enough.
//!
//! `by_definition` is that rule; the tests' oracle follows it. The paper keeps a priority queue. But a node is no
//! larger than its parent, so that opening the largest first opens all nodes above some area. [`initial_cut`] finds
//! that area, halving it until too many nodes would be opened, and then walks down to the nodes that are not. No queue
//! is kept in order, and the children of many nodes are on their way from memory at once.

use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::memory::huge_pages;
use crate::memory::prefetch::line;

/// The initial cut below `root` in the order of the tree: nodes of an area of more than `threshold` are opened, the
/// largest first and of equal ones the first, while there are fewer than `max_len`. A lone root is opened whatever its
/// size. `open` gives the children of an inner node.
#[cfg(test)]
pub(crate) fn by_definition<T>(
    root: T,
    threshold: f32,
    max_len: usize,
    area: impl Fn(&T) -> f32,
    open: impl Fn(&T) -> Option<[T; 2]>,
) -> Vec<T> {
    let mut cut = vec![root];
    while cut.len() < max_len {
        let inner = (0..cut.len()).filter(|&i| open(&cut[i]).is_some());
        let largest = inner.reduce(|a, b| if area(&cut[b]) > area(&cut[a]) { b } else { a });
        let Some(i) = largest.filter(|&i| area(&cut[i]) > threshold || cut.len() == 1) else { break };
        let children = open(&cut[i]).expect("it is an inner node");
        cut.splice(i..=i, children);
    }
    cut
}

/// The same of a tree by half areas, as `by_definition` has it.
pub(crate) fn initial_cut(tree: &BinaryTree, root: Node, threshold: f32, max_len: usize) -> Vec<Node> {
    // Each node that is opened adds one.
    let room = max_len.saturating_sub(1);
    if room == 0 || root.is_leaf() {
        return vec![root];
    }
    if root.bounds().half_area() <= threshold {
        return tree.children(&root).to_vec();
    }
    let (least, mut equal) = least_opened(tree, &root, threshold, room);
    let mut cut = Vec::new();
    let mut stack = vec![root];
    while let Some(node) = stack.pop() {
        let area = node.bounds().half_area();
        let is_first = area == least && equal > 0;
        if !node.is_leaf() && (area > least || is_first) {
            equal -= usize::from(is_first);
            stack.extend(tree.children(&node).iter().rev());
        } else {
            huge_pages::push(&mut cut, node, "cuts");
        }
    }
    cut
}

/// The half area that all opened nodes exceed, but for the first of those that equal it, and how many these are, so
/// that no more than `room` nodes are opened.
fn least_opened(tree: &BinaryTree, root: &Node, threshold: f32, room: usize) -> (f32, usize) {
    let inner = |node: &Node| node.pair().map(|pair| (node.bounds().half_area(), pair));
    // Inner nodes that are not opened: half areas, and pairs of children. Half areas of those that are.
    let mut closed: Vec<(f32, usize)> = inner(root).into_iter().collect();
    let mut opened = Vec::new();
    loop {
        let largest = closed.iter().fold(threshold, |largest, &(area, _)| largest.max(area));
        if largest <= threshold {
            return (threshold, 0);
        }
        let above = (largest.min(f32::MAX) * 0.5).max(threshold);
        let (mut next, mut kept) = (0, 0);
        while let Some(&(area, pair)) = closed.get(next) {
            next += 1;
            if area > above {
                huge_pages::push(&mut opened, area, "cuts");
                // At the end: until they are looked at, their own children have come from memory.
                for (area, pair) in tree.pairs[pair].iter().filter_map(inner) {
                    line(&tree.pairs, pair);
                    huge_pages::push(&mut closed, (area, pair), "cuts");
                }
            } else {
                closed[kept] = (area, pair);
                kept += 1;
            }
        }
        closed.truncate(kept);
        if opened.len() > room {
            let (larger, &mut least, _) = opened.select_nth_unstable_by(room - 1, |a, b| b.total_cmp(a));
            let larger = larger.iter().filter(|&&area| area > least).count();
            return (least, room - larger);
        }
    }
}
