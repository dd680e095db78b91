//! Cuts of the auxiliary BVH: the initial one (paper 4.1), clipping under spatial splits (4.4), leaves.

use super::binary::{BinaryTree, Node};
use crate::geometry::Aabb;
use std::collections::BinaryHeap;

/// All of space: the clip box above the first spatial split.
pub(super) const SPACE: Aabb = Aabb::new(glam::Vec3A::NEG_INFINITY, glam::Vec3A::INFINITY);

/// A cut: disjoint subtrees of the auxiliary BVH in its depth-first order, which is that of the Morton codes.
/// Their boxes are clipped.
#[derive(Clone, Debug)]
pub(super) struct Cut {
    /// The subtrees.
    pub nodes: Vec<Node>,
    /// What spatial splits above have left of space; each finite face lies in a split plane.
    pub clip: Aabb,
    /// The union of the nodes' clipped boxes.
    pub bounds: Aabb,
    /// Triangles below.
    pub count: u32,
    /// Triangle references that may be made below: bounds duplication by spatial splits.
    pub capacity: u32,
    /// Binary splits above.
    pub depth: u32,
    /// To be a leaf.
    pub is_leaf: bool,
}

impl Cut {
    /// The initial cut (paper 4.1): nodes larger than `threshold` (half area) are opened, the largest first,
    /// until none is left or the cut has `max_len` nodes.
    pub fn initial(tree: &BinaryTree, root: Node, threshold: f32, max_len: usize) -> Vec<Node> {
        let mut queue = BinaryHeap::from([Queued { area: root.bounds().half_area(), order: 0, node: root }]);
        let mut cut = Vec::new();
        let mut order = 0;
        while let Some(Queued { area, node, .. }) = queue.pop() {
            let last_chance = cut.len() + queue.len() + 1 >= max_len;
            // A lone root is opened whatever its size, or there would be nothing to split.
            let lone = cut.is_empty() && queue.is_empty();
            if node.is_leaf() || !(area > threshold || lone) || last_chance {
                cut.push(node);
                continue;
            }
            for child in *tree.children(&node) {
                order += 1;
                queue.push(Queued { area: child.bounds().half_area(), order, node: child });
            }
        }
        depth_first(tree, root, cut)
    }
}

/// Orders the nodes of a cut as the tree has them.
fn depth_first(tree: &BinaryTree, root: Node, cut: Vec<Node>) -> Vec<Node> {
    // Two subtrees can share neither a first triangle nor a pair: (count, link) names a node.
    let members: std::collections::HashSet<(u32, u32)> = cut.iter().map(Node::key).collect();
    let mut ordered = Vec::with_capacity(cut.len());
    let mut stack = vec![root];
    while let Some(node) = stack.pop() {
        if members.contains(&node.key()) {
            ordered.push(node);
        } else {
            let [left, right] = *tree.children(&node);
            stack.extend([right, left]);
        }
    }
    ordered
}

/// An entry of the initial cut's priority queue: largest area first, then first come.
struct Queued {
    area: f32,
    order: u32,
    node: Node,
}

impl Ord for Queued {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.area.total_cmp(&other.area).then(other.order.cmp(&self.order))
    }
}

impl PartialOrd for Queued {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Queued {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Queued {}

/// Gives `take` the children of `node` that reach into `clip`, their boxes clipped.
///
/// A box that merely touches a split plane from one side belongs to that side alone, and one that lies in the
/// plane belongs to the left, unless its parent began at the plane and so never was there: else an
/// axis-aligned wall in the plane would be on both sides, or on neither.
#[inline]
pub(super) fn open(tree: &BinaryTree, node: &Node, clip: &Aabb, mut take: impl FnMut(Node)) {
    let children = tree.children(node);
    if *clip == SPACE {
        take(children[0]);
        take(children[1]);
        return;
    }
    let parent = children[0].bounds().union(children[1].bounds());
    for child in children {
        let b = child.bounds();
        // Right of a split plane (clip.min): what ends there is on the left, if the parent was there at all.
        let left_of = b.max.cmple(clip.min) & parent.min.cmplt(clip.min);
        // Left of a split plane (clip.max): what begins there and goes on is on the right.
        let right_of = b.min.cmpge(clip.max) & b.max.cmpgt(clip.max);
        if !(left_of | right_of).any() {
            take(child.with_bounds(b.intersection(*clip)));
        }
    }
}

/// Appends the triangles below `node`, a member of a cut clipped to `clip`, and grows `bounds` by their
/// clipped boxes.
pub(super) fn gather(tree: &BinaryTree, node: &Node, clip: &Aabb, ids: &mut Vec<u32>, bounds: &mut Aabb) {
    if node.is_leaf() {
        ids.push(node.prim());
        *bounds = bounds.union(node.bounds());
        return;
    }
    open(tree, node, clip, |child| gather(tree, &child, clip, ids, bounds));
}
