//! A binary tree in the form of an LBVH: its references are put into the order of its leaves, so that every subtree is a
//! run of them, and the pairs below a node lie in a row that ends with its own. Small subtrees become leaves.

use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::lbvh::key::MortonKey;
use crate::builders::lbvh::treelet::LeafRule;
use crate::memory::huge_pages;
use crate::memory::pool::Pool;
use crate::parallel::ordered_append::{self, Chunk, Offset};
use crate::parallel::task_tree::{Division, TaskTree};

/// Subtrees of at most so many references are copied by one task.
const GRAIN: u32 = 1 << 12;

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
    let divided = TaskTree::grow((root, 0), &|(node, first): (Node, u32)| {
        if node.count() <= GRAIN || node.is_leaf() {
            return Division::Task((node, first));
        }
        let [left, right] = tree.children(&node);
        Division::Parts(vec![(*left, first), (*right, first + left.count())])
    });
    let (divided, tasks) = divided.number();
    let pairs = &mut ordered.pairs;
    let copied = ordered_append::append(
        tasks.len(),
        &Pool::default(),
        pairs,
        &mut ordered_keys,
        |task, copied: &mut Copied| {
            let (node, first) = tasks.take(task);
            copied.subtree((tree, keys), &node, first, rule)
        },
    );
    let copied: Vec<Node> = copied.into_iter().map(|(node, [first, _])| node.moved(first as u32)).collect();
    ordered.root = Some(divided.fold(&copied, &mut |parts| {
        pairs.push([parts[0], parts[1]]);
        Node::inner(&[parts[0], parts[1]], pairs.len() - 1)
    }));
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
        rule: LeafRule,
    ) -> Node {
        let (tree, keys) = from;
        if node.is_leaf() || rule.is_leaf(node.count(), node.bounds()) {
            self.references(from, node);
            return Node::leaf(node.bounds(), first as usize, node.count());
        }
        let [left, right] = tree.children(node);
        tree.prefetch(right);
        let left_copy = self.subtree((tree, keys), left, first, rule);
        let right_copy = self.subtree((tree, keys), right, first + left.count(), rule);
        self.pairs.push([left_copy, right_copy]);
        Node::inner(&[left_copy, right_copy], self.pairs.len() - 1)
    }

    /// Appends the references below `node`.
    fn references(&mut self, from: (&BinaryTree, &[MortonKey]), node: &Node) {
        match node.pair() {
            None => self.keys.extend_from_slice(&from.1[node.run()]),
            Some(_) => from.0.children(node).iter().for_each(|child| self.references(from, child)),
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
