//! The LBVH over a run of sorted codes that fits the cache. It needs no search: it is the Cartesian tree of the
//! bits in which neighbouring codes differ, made in one pass with a stack (cf. Apetrei 2014).

use super::binary::{BinaryTree, Node};
use super::in_order::{Batch, Place};
use super::morton_order::{Key, code, part_boxed, reference};
use super::references::References;
use crate::geometry::Aabb;

/// A subtree on the stack, and in which bits its first code differs from the one before.
#[derive(Clone, Copy)]
struct Pending {
    node: Node,
    difference: u64,
}

/// The subtree over one run, built by one task; links are relative to its own pairs.
#[derive(Default)]
pub(super) struct Run {
    /// The subtree.
    pub tree: BinaryTree,
    items: Vec<(Key, Aabb)>,
    stack: Vec<Pending>,
}

impl Run {
    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        self.items.capacity() * size_of::<(Key, Aabb)>() + self.tree.pairs.capacity() * size_of::<[Node; 2]>()
    }

    /// Builds the subtree over `keys`, which begin at position `first` and have been parted by the middle `depth`
    /// times; subtrees of at most `leaf` references become leaves. Returns the root.
    pub fn build(
        &mut self,
        references: &References<'_>,
        keys: &mut [Key],
        first: usize,
        depth: u32,
        leaf: u32,
    ) -> Node {
        // All boxes first: a plain loop has many loads from memory on their way at once.
        self.items.clear();
        self.items.extend(keys.iter().map(|&key| (key, references.bounds(reference(key)))));
        self.stack.clear();
        self.tree.pairs.clear();
        let mut items = std::mem::take(&mut self.items);
        let mut at = 0;
        let mut before = 0;
        while at < items.len() {
            let own = code(items[at].0);
            let equal = 1 + items[at + 1..].iter().take_while(|(key, _)| code(*key) == own).count();
            let node = if equal == 1 {
                Node::leaf(items[at].1, first + at, 1)
            } else {
                self.same_code(&mut items[at..at + equal], first + at, depth, leaf)
            };
            let difference = if at == 0 { u64::MAX } else { u64::from(own ^ before) };
            self.unite_below(difference, leaf);
            self.stack.push(Pending { node, difference });
            before = own;
            at += equal;
        }
        self.unite_below(u64::MAX, leaf);
        for (key, item) in keys.iter_mut().zip(&items) {
            *key = item.0;
        }
        self.items = items;
        debug_assert_eq!(self.stack.len(), 1);
        let root = self.stack[0].node;
        self.tree.root = Some(root);
        root
    }

    /// Unites the subtrees on the stack that differ in lower bits than `difference`.
    #[inline]
    fn unite_below(&mut self, difference: u64, leaf: u32) {
        while let [.., left, right] = &self.stack[..]
            && right.difference < difference
        {
            let (left, right) = (*left, right.node);
            self.stack.pop();
            let node = self.unite(left.node, right, leaf);
            *self.stack.last_mut().expect("the left one") = Pending { node, difference: left.difference };
        }
    }

    /// The parent of two subtrees, a leaf if they hold few references.
    #[inline]
    fn unite(&mut self, left: Node, right: Node, leaf: u32) -> Node {
        let count = left.count() + right.count();
        if count <= leaf {
            return Node::leaf(left.bounds().union(right.bounds()), left.run().start, count);
        }
        let children = [left, right];
        self.tree.pairs.push(children);
        Node::inner(&children, self.tree.pairs.len() - 1)
    }

    /// The subtree over references of one code.
    fn same_code(&mut self, items: &mut [(Key, Aabb)], first: usize, depth: u32, leaf: u32) -> Node {
        if items.len() <= leaf as usize {
            let bounds = items.iter().map(|(_, bounds)| *bounds).collect();
            return Node::leaf(bounds, first, items.len() as u32);
        }
        let split = part_boxed(items, depth + 1);
        let (left, right) = items.split_at_mut(split);
        let left = self.same_code(left, first, depth + 1, leaf);
        let right = self.same_code(right, first + split, depth + 1, leaf);
        self.unite(left, right, leaf)
    }
}

impl Batch for Run {
    type A = [Node; 2];
    type B = ();

    fn elements(&self) -> (&[[Node; 2]], &[()]) {
        (&self.tree.pairs, &[])
    }

    fn moved(pair: &[Node; 2], at: Place) -> [Node; 2] {
        pair.map(|node| node.moved(at[0] as u32))
    }

    fn clear(&mut self) {
        self.tree.pairs.clear();
    }
}
