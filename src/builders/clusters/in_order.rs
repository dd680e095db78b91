//! A binary tree in the form of an LBVH: its references are put into the order of its leaves, so that every subtree
//! is a run of them, and the pairs below a node lie in a row that ends with its own. Small subtrees become leaves.

use crate::builders::binary::node::Node;
use crate::builders::binary::tree::{BinaryTree, MOST_DIVIDED_LEVELS, TREELET};
use crate::builders::lbvh::key::MortonKey;
use crate::builders::lbvh::treelet::LeafRule;
use crate::memory::huge_pages;
use crate::memory::pool::Pool;
use crate::parallel::ordered_append::{self, Chunk, Offset};
use crate::parallel::task_tree::{Division, TaskTree};

/// Levels below the root of a task's subtree from which on references are halved by count: nothing bounds the depth of
/// clusters of clusters (AAC with a large delta), and what reads the tree goes down it by recursion.
const DEEPEST: u32 = 1024;

/// The keys of `tree` in the order of its leaves; the tree itself goes to `ordered`.
pub(crate) fn in_order(
    tree: &BinaryTree,
    keys: &[MortonKey],
    rule: LeafRule,
    ordered: &mut BinaryTree,
) -> Vec<MortonKey> {
    let mut ordered_keys = Vec::new();
    ordered.pairs.clear();
    ordered.root = None;
    let Some(root) = tree.root else { return ordered_keys };
    huge_pages::reserve(&mut ordered_keys, keys.len(), "ordered keys");
    huge_pages::reserve(&mut ordered.pairs, tree.pairs.len(), "ordered pairs");
    let divided = TaskTree::grow((root, 0, 0), &|(node, first, level): (Node, u32, u32)| {
        if node.count() <= TREELET as u32 || node.is_leaf() || level == MOST_DIVIDED_LEVELS {
            return Division::Task((node, first, level));
        }
        let [left, right] = tree.children(&node);
        Division::Parts(vec![(*left, first, level + 1), (*right, first + left.count(), level + 1)])
    });
    let (divided, tasks) = divided.number();
    let pairs = &mut ordered.pairs;
    let copied = ordered_append::append(
        tasks.len(),
        &Pool::default(),
        pairs,
        &mut ordered_keys,
        |task, copied: &mut Copied| {
            let (node, first, _) = tasks.take(task);
            copied.subtree((tree, keys), &node, first, DEEPEST, rule)
        },
    );
    let copied: Vec<Node> = copied.into_iter().map(|(node, [first, _])| node.moved(first as u32)).collect();
    ordered.root = Some(divided.fold(&copied, &mut |parts| Node::join([parts[0], parts[1]], pairs)));
    ordered_keys
}

/// The pairs of a subtree and its references.
#[derive(Default)]
struct Copied {
    pairs: Vec<[Node; 2]>,
    keys: Vec<MortonKey>,
}

impl Copied {
    /// Appends the subtree of `node`, whose references begin at position `first`.
    fn subtree(
        &mut self,
        from: (&BinaryTree, &[MortonKey]),
        node: &Node,
        first: u32,
        levels: u32,
        rule: LeafRule,
    ) -> Node {
        let (tree, keys) = from;
        if node.is_leaf() || rule.is_leaf(node.count(), node.bounds()) {
            leaves(tree, node, |leaf| self.keys.extend_from_slice(&keys[leaf.run()]));
            return Node::leaf(node.bounds(), first as usize, node.count());
        }
        if levels == 0 {
            let mut all = Vec::new();
            leaves(tree, node, |leaf| all.push(*leaf));
            return self.halved(keys, &all, first, rule);
        }
        let [left, right] = tree.children(node);
        tree.prefetch(right);
        let left_copy = self.subtree(from, left, first, levels - 1, rule);
        let right_copy = self.subtree(from, right, first + left.count(), levels - 1, rule);
        Node::join([left_copy, right_copy], &mut self.pairs)
    }

    /// Appends a subtree over the leaves of another, halved by count.
    fn halved(&mut self, keys: &[MortonKey], leaves: &[Node], first: u32, rule: LeafRule) -> Node {
        let bounds = leaves.iter().map(Node::bounds).collect();
        let count = leaves.iter().map(Node::count).sum();
        if leaves.len() == 1 || rule.is_leaf(count, bounds) {
            leaves.iter().for_each(|leaf| self.keys.extend_from_slice(&keys[leaf.run()]));
            return Node::leaf(bounds, first as usize, count);
        }
        let (left, right) = leaves.split_at(leaves.len() / 2);
        let left_half = self.halved(keys, left, first, rule);
        let right_half = self.halved(keys, right, first + left_half.count(), rule);
        Node::join([left_half, right_half], &mut self.pairs)
    }
}

/// Calls `take` with the leaves below `node`, in order, without a recursion.
fn leaves(tree: &BinaryTree, node: &Node, mut take: impl FnMut(&Node)) {
    let mut pending = vec![node];
    while let Some(node) = pending.pop() {
        match node.pair() {
            None => take(node),
            Some(pair) => pending.extend(tree.pairs[pair].iter().rev()),
        }
    }
}

impl Chunk for Copied {
    type A = [Node; 2];
    type B = MortonKey;

    fn elements(&self) -> (&[[Node; 2]], &[MortonKey]) {
        (&self.pairs, &self.keys)
    }

    fn moved(pair: &[Node; 2], [first, _]: Offset) -> [Node; 2] {
        pair.map(|node| node.moved(first as u32))
    }

    fn clear(&mut self) {
        self.pairs.clear();
        self.keys.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use glam::Vec3A;

    #[test]
    fn chains_of_any_length_become_trees_of_bounded_depth() {
        let n = 300_000;
        let leaf = |i: usize| Node::leaf(Aabb::new(Vec3A::ZERO, Vec3A::splat(i as f32)), i, 1);
        let (mut chain, mut root) = (BinaryTree::default(), leaf(0));
        for i in 1..n {
            chain.pairs.push([root, leaf(i)]);
            root = Node::inner(&[root, leaf(i)], i - 1);
        }
        chain.root = Some(root);
        let keys: Vec<MortonKey> = (0..n as MortonKey).collect();
        let mut ordered = BinaryTree::default();
        let rule = LeafRule { always: 1, most: 1, area: 0.0 };
        assert_eq!(in_order(&chain, &keys, rule, &mut ordered), keys);
        let (mut depth, mut pending) = (0, vec![(ordered.root.unwrap(), 0)]);
        assert_eq!((pending[0].0.count() as usize, ordered.pairs.len()), (n, n - 1));
        while let Some((node, level)) = pending.pop() {
            depth = depth.max(level);
            if !node.is_leaf() {
                let children = ordered.children(&node);
                assert_eq!(children[0].bounds().union(children[1].bounds()), node.bounds());
                pending.extend(children.map(|child| (child, level + 1)));
            }
        }
        assert!(depth > DEEPEST && depth < DEEPEST + MOST_DIVIDED_LEVELS + 20, "{depth}");
    }
}
