//! Paper 4.1: the initial cut. From the root on, the largest node is opened, until none is larger than a threshold or
//! the cut is long enough.
//!
//! `by_definition` is that rule; the tests' oracle follows it. The paper keeps a priority queue. But a node is no
//! larger than its parent, so that opening the largest first opens all nodes above some area. [`initial_cut`] halves
//! that area until too many nodes would be opened; then the last one that may be is selected among them. No queue is
//! needed, and much of a cut is opened at a time, in parallel.

use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::memory::huge_pages;
use crate::parallel;

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

/// Nodes opened by one task.
const CHUNK: usize = 1 << 7;

/// The same of a tree by half areas, as `by_definition` has it.
pub(crate) fn initial_cut(tree: &BinaryTree, root: Node, threshold: f32, max_len: usize) -> Vec<Node> {
    let mut cut = vec![root];
    // Each node that is opened adds one.
    let mut room = max_len.saturating_sub(1);
    let mut largest = root.bounds().half_area();
    if room > 0 && !root.is_leaf() && largest <= threshold {
        return tree.children(&root).to_vec();
    }
    while room > 0 && largest > threshold {
        let above = (largest.min(f32::MAX) * 0.5).max(threshold);
        let mut opened = OpenedCut::of(tree, &cut, |area| area > above);
        if opened.areas.len() > room {
            let (larger, &mut least, _) =
                opened.areas.select_nth_unstable_by(room - 1, |a, b| b.total_cmp(a));
            let larger = larger.iter().filter(|&&area| area > least).count();
            return up_to(tree, &cut, least, room - larger, &opened.areas);
        }
        room -= opened.areas.len();
        largest = opened.largest;
        cut = opened.nodes;
    }
    cut
}

/// Opens the nodes whose half area exceeds `least`, and the first `equal` of those whose half area equals it; `areas`
/// holds the half areas of all of them, among others.
fn up_to(tree: &BinaryTree, cut: &[Node], least: f32, equal: usize, areas: &[f32]) -> Vec<Node> {
    if areas.iter().filter(|&&area| area == least).count() == equal {
        return OpenedCut::of(tree, cut, |area| area >= least).nodes;
    }
    let mut room = equal;
    let mut opened = OpenedCut::default();
    opened.open(tree, cut, |area| {
        let is_one = area == least && room > 0;
        room -= usize::from(is_one);
        area > least || is_one
    });
    opened.nodes
}

/// The result of opening nodes of a cut.
#[derive(Default)]
struct OpenedCut {
    /// The nodes, in the order of the tree.
    nodes: Vec<Node>,
    /// Half areas of those that were opened.
    areas: Vec<f32>,
    /// The largest of the half areas of inner nodes that were not.
    largest: f32,
}

impl OpenedCut {
    /// Opens nodes, and nodes below them, as long as `is_opened` says so of their half areas.
    fn of(tree: &BinaryTree, cut: &[Node], is_opened: impl Fn(f32) -> bool + Sync) -> Self {
        let chunks = parallel::map(cut.chunks(CHUNK), |chunk| {
            let mut opened = Self::default();
            opened.open(tree, chunk, &is_opened);
            opened
        });
        Self {
            nodes: chunks.iter().flat_map(|chunk| &chunk.nodes).copied().collect(),
            areas: chunks.iter().flat_map(|chunk| &chunk.areas).copied().collect(),
            largest: chunks.iter().map(|chunk| chunk.largest).fold(0.0, f32::max),
        }
    }

    fn open(&mut self, tree: &BinaryTree, cut: &[Node], mut is_opened: impl FnMut(f32) -> bool) {
        let mut stack = Vec::new();
        for &node in cut {
            stack.push(node);
            while let Some(node) = stack.pop() {
                let area = node.bounds().half_area();
                if node.is_leaf() {
                    huge_pages::push(&mut self.nodes, node, "cuts");
                } else if is_opened(area) {
                    huge_pages::push(&mut self.areas, area, "cuts");
                    let [left, right] = *tree.children(&node);
                    tree.prefetch(&right);
                    stack.extend([right, left]);
                } else {
                    self.largest = self.largest.max(area);
                    huge_pages::push(&mut self.nodes, node, "cuts");
                }
            }
        }
    }
}
