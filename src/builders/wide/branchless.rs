//! The wide nodes of `lbvh` and of finished clusters, without a branch that depends on the tree, as their areas and
//! leaves are known in advance. As [`super::open_largest`] (paper 4.5), but a child with no more leaves than a node has
//! slots is opened only if all its leaves fit into the slots that are free. Else it has a node of its own, which is
//! fuller: opened in part it would leave several nodes of few children.
//!
//! A child that cannot be opened is replaced by itself, and unused slots are children like others. Nodes are found
//! level by level, so that the processor has many in flight; as nodes lie in the order of the pairs they are over,
//! their indices follow by counting.

use crate::builders::binary::tagged::TaggedBox;
use crate::bvh::{Link, WideNode};
use crate::geometry::Aabb;

/// A binary subtree that may become a child of a wide node. Tags: the index of the pair of children or the [`Link`]
/// of a leaf, and an order, which grows with the area of an inner node and is negative for leaves and others that
/// are not opened. The last four bits of the area give way to the number of leaves below, 0 if a node cannot hold them.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Slot(TaggedBox);

impl Slot {
    const LEAF: u32 = 1 << 31;
    const CLOSED: u32 = Self::LEAF | 1;
    const BARE: u32 = Self::LEAF | 2;
    /// The bits of an order that are a number of leaves.
    const LEAVES: u32 = 15;

    /// An unused slot.
    pub const NONE: Self = Self(TaggedBox::empty([u32::MAX, Self::LEAF]));

    /// The leaf of the given block.
    #[inline]
    pub fn leaf(bounds: Aabb, block: usize) -> Self {
        Self(TaggedBox::new(bounds, [Link::of_blocks(block, 1).bits(), Self::LEAF]))
    }

    /// The parent of a pair of children, for nodes of `N`.
    #[inline]
    pub fn inner<const N: usize>(children: &[Self; 2], pair: usize) -> Self {
        let bounds = children[0].bounds().union(children[1].bounds());
        let leaves = children[0].leaves() + children[1].leaves();
        let leaves = if leaves <= N as u32 { leaves } else { 0 };
        // Positive floats are ordered as their bits are.
        let area = bounds.half_area().to_bits() & !Self::LEAVES;
        Self(TaggedBox::new(bounds, [pair as u32, area | leaves]))
    }

    /// The number of leaves below, if a node can hold them; else more than it can.
    #[inline]
    fn leaves(&self) -> u32 {
        let order = self.0.second();
        let below =
            if order > Self::LEAF || order & Self::LEAVES == 0 { Self::LEAVES } else { order & Self::LEAVES };
        if self.is_leaf() { 1 } else { below }
    }

    /// The parent of a pair of children that is no part of a wide node.
    #[inline]
    pub fn closed(bounds: Aabb, pair: usize) -> Self {
        Self(TaggedBox::new(bounds, [pair as u32, Self::CLOSED]))
    }

    /// A leaf without a block that is no part of a wide node.
    #[inline]
    pub fn bare(bounds: Aabb) -> Self {
        Self(TaggedBox::new(bounds, [u32::MAX, Self::BARE]))
    }

    /// Whether it is the leaf of a block.
    #[inline(always)]
    pub fn is_leaf(&self) -> bool {
        self.0.second() == Self::LEAF
    }

    /// Whether it is the parent of a pair that is no part of a wide node.
    #[inline(always)]
    pub fn is_closed(&self) -> bool {
        self.0.second() == Self::CLOSED
    }

    /// Whether it is a leaf without a block.
    #[inline(always)]
    pub fn is_bare(&self) -> bool {
        self.0.second() == Self::BARE
    }

    /// The index of the pair of children, or of the block.
    #[inline(always)]
    pub fn index(&self) -> usize {
        (self.link() & !Self::LEAF) as usize
    }

    /// The box.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        self.0.bounds()
    }

    #[inline]
    fn link(&self) -> u32 {
        self.0.first()
    }

    #[inline]
    fn order(&self) -> i32 {
        self.0.second() as i32
    }
}

/// Memory to widen a tree in, to nodes of `N` children.
#[derive(Default)]
pub(crate) struct Widen<const N: usize> {
    /// Siblings, children before parents.
    pub pairs: Vec<[Slot; 2]>,
    /// The children of the wide node over a pair, as indices of slots.
    children: Vec<[u32; N]>,
    /// Whether a wide node lies over a pair.
    is_node: Vec<bool>,
    /// The index of the node over a pair.
    numbers: Vec<u32>,
    /// Pairs with a node: first level by level, then in order.
    nodes: Vec<u32>,
}

impl<const N: usize> Widen<N> {
    /// Appends the wide nodes below `root`, over the last of the pairs.
    #[inline(always)]
    pub fn write(&mut self, root: &Slot, nodes: &mut Vec<WideNode<N>>) -> Link {
        let pairs = self.pairs.len();
        if pairs == 0 {
            return Link::from_bits(root.link());
        }
        self.write_below(&[pairs as u32 - 1], nodes);
        Link::of_node(nodes.len() - 1)
    }

    /// Appends the wide nodes over and below some pairs, none of which is below another, in the order of the pairs.
    #[inline(always)]
    pub fn write_below(&mut self, roots: &[u32], nodes: &mut Vec<WideNode<N>>) {
        self.find_nodes(roots);
        let Self { pairs, children, numbers, nodes: of_nodes, .. } = self;
        let first = nodes.len() as u32;
        let slots = pairs.as_flattened();
        let link = |slot: &Slot| {
            let link = slot.link();
            let is_inner = slot.order() >= 0;
            // Leaves look up number 0, which is not used.
            let number = numbers[if is_inner { link as usize } else { 0 }];
            Link::from_bits(if is_inner { first + number } else { link })
        };
        nodes.extend(of_nodes.iter().map(|&pair| {
            let children = &children[pair as usize];
            let (mut boxes, mut links) = ([Aabb::EMPTY; N], [Link::EMPTY; N]);
            for i in 0..N {
                let slot = &slots[children[i] as usize];
                boxes[i] = slot.0.bounds_with_tags();
                links[i] = link(slot);
            }
            WideNode::of_slots(&boxes, links)
        }));
        self.pairs.pop();
    }

    /// The number of the wide node over a pair among those last made.
    #[inline]
    pub fn number(&self, pair: usize) -> u32 {
        self.numbers[pair]
    }

    /// Finds the pairs over which nodes lie, `roots` and pairs below them, and their children.
    #[inline(always)]
    fn find_nodes(&mut self, roots: &[u32]) {
        let Self { pairs, children, is_node, numbers, nodes } = self;
        let count = pairs.len();
        // One more, of unused slots.
        pairs.push([Slot::NONE; 2]);
        let none = 2 * count as u32;
        let slots = pairs.as_flattened();
        children.resize(count, [0; N]);
        numbers.resize(count, 0);
        is_node.clear();
        is_node.resize(count, false);
        nodes.resize(count + N, 0);
        nodes[..roots.len()].copy_from_slice(roots);
        let (mut next, mut found) = (0, roots.len());
        while next < found {
            let pair = nodes[next];
            next += 1;
            is_node[pair as usize] = true;
            let slots_of = children_of(slots, pair, none);
            children[pair as usize] = slots_of;
            for slot in slots_of {
                let slot = &slots[slot as usize];
                nodes[found] = slot.link();
                found += usize::from(slot.order() >= 0);
            }
        }
        let mut number = 0;
        for pair in 0..count {
            nodes[number] = pair as u32;
            numbers[pair] = number as u32;
            number += usize::from(is_node[pair]);
        }
        nodes.truncate(number);
    }
}

/// The children of the wide node over a pair, in order; `none` is an unused slot.
#[inline(always)]
fn children_of<const N: usize>(slots: &[Slot], pair: u32, none: u32) -> [u32; N] {
    let order = |slot: u32| slots[slot as usize].order();
    let mut children = [none; N];
    let mut orders = [order(none); N];
    for (i, slot) in [2 * pair, 2 * pair + 1].into_iter().enumerate() {
        (children[i], orders[i]) = (slot, order(slot));
    }
    for used in 2..N {
        // Whoever is opened takes a slot more for each leaf but one.
        let most_leaves = (N - used + 1) as i32;
        let (mut at, mut largest, mut slot) = (0, -1, children[0]);
        // Unused slots too, which are never larger: a fixed number of steps is unrolled to vectors.
        for i in 0..N {
            let is_larger = (orders[i] > largest) & (orders[i] & Slot::LEAVES as i32 <= most_leaves);
            at = if is_larger { i } else { at };
            slot = if is_larger { children[i] } else { slot };
            largest = if is_larger { orders[i] } else { largest };
        }
        // A node of eight has many steps; those that it may save are worth a branch.
        if N > 4 && largest < 0 {
            break;
        }
        // Instead of a leaf the unused slots are opened, and put behind the last place.
        let is_open = largest >= 0;
        let first = if is_open { 2 * slots[slot as usize].link() } else { none };
        at = if is_open { at } else { N };
        children = replaced(children, at, [first, first + 1]);
        orders = replaced(orders, at, [order(first), order(first + 1)]);
    }
    children
}

/// `old` with the element at an index replaced by two, and without the last one.
#[inline(always)]
fn replaced<T: Copy, const N: usize>(old: [T; N], at: usize, [left, right]: [T; 2]) -> [T; N] {
    let mut new = old;
    for i in 0..N {
        let before = if i == at + 1 { right } else { old[i.saturating_sub(1)] };
        let moved = if i == at { left } else { before };
        new[i] = if i < at { old[i] } else { moved };
    }
    new
}
