//! Paper 4.5 without a branch that depends on the tree, for builders that know all areas and leaves in advance; the nodes
//! are those of [`super::open_largest`].
//!
//! A child that cannot be opened is replaced by itself, and unused slots are children like others. Nodes are found level
//! by level, so that the processor has many in flight; as nodes lie in the order of the pairs they are over, their
//! indices follow by counting.

use crate::builders::binary::tagged::TaggedBox;
use crate::bvh::limits::WIDTH;
use crate::bvh::{Link, WideNode};
use crate::geometry::Aabb;

/// A binary subtree that may become a child of a wide node. Tags: the index of the pair of children or the [`Link`] of a
/// leaf, and an order, which grows with the area of an inner node and is negative for leaves.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Slot(TaggedBox);

impl Slot {
    const LEAF: u32 = 1 << 31;

    /// An unused slot.
    pub const NONE: Self = Self(TaggedBox::empty([u32::MAX, Self::LEAF]));

    /// The leaf of the given block.
    #[inline]
    pub fn leaf(bounds: Aabb, block: usize) -> Self {
        Self(TaggedBox::new(bounds, [Link::leaf(block, 1).bits(), Self::LEAF]))
    }

    /// The parent of a pair of children.
    #[inline]
    pub fn inner(children: &[Self; 2], pair: usize) -> Self {
        let bounds = children[0].bounds().union(children[1].bounds());
        // Positive floats are ordered as their bits are.
        Self(TaggedBox::new(bounds, [pair as u32, bounds.half_area().to_bits()]))
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

/// Memory to widen a tree in.
#[derive(Default)]
pub(crate) struct Widen {
    /// Siblings, children before parents.
    pub pairs: Vec<[Slot; 2]>,
    /// The children of the wide node over a pair, as indices of slots.
    children: Vec<[u32; WIDTH]>,
    /// Whether a wide node lies over a pair.
    is_node: Vec<bool>,
    /// The index of the node over a pair.
    numbers: Vec<u32>,
    /// Pairs with a node: first level by level, then in order.
    nodes: Vec<u32>,
}

impl Widen {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.pairs.capacity() * size_of::<[Slot; 2]>()
            + self.children.capacity() * size_of::<[u32; WIDTH]>()
            + self.is_node.capacity()
            + (self.numbers.capacity() + self.nodes.capacity()) * size_of::<u32>()
    }

    /// Appends the wide nodes below `root`, over the last of the pairs.
    pub fn write(&mut self, root: &Slot, nodes: &mut Vec<WideNode<WIDTH>>) -> Link {
        let pairs = self.pairs.len();
        if pairs == 0 {
            return Link::from_bits(root.link());
        }
        self.find_nodes();
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
            let [a, b, c, d] = children[pair as usize];
            let [a, b, c, d] =
                [&slots[a as usize], &slots[b as usize], &slots[c as usize], &slots[d as usize]];
            let links = [link(a), link(b), link(c), link(d)];
            let boxes = [
                a.0.bounds_with_tags(),
                b.0.bounds_with_tags(),
                c.0.bounds_with_tags(),
                d.0.bounds_with_tags(),
            ];
            WideNode::of_slots(boxes, links)
        }));
        self.pairs.pop();
        Link::inner(nodes.len() - 1)
    }

    /// Finds the pairs over which nodes lie, and their children.
    fn find_nodes(&mut self) {
        let Self { pairs, children, is_node, numbers, nodes } = self;
        let count = pairs.len();
        // One more, of unused slots.
        pairs.push([Slot::NONE; 2]);
        let none = 2 * count as u32;
        let slots = pairs.as_flattened();
        children.resize(count, [0; WIDTH]);
        numbers.resize(count, 0);
        is_node.clear();
        is_node.resize(count, false);
        nodes.resize(count + WIDTH, 0);
        nodes[0] = count as u32 - 1;
        let (mut next, mut found) = (0, 1);
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
#[inline]
fn children_of(slots: &[Slot], pair: u32, none: u32) -> [u32; WIDTH] {
    let order = |slot: u32| slots[slot as usize].order();
    // Instead of a leaf the unused slots are opened, and the result is not used.
    let open = |slot: u32, order: i32| if order >= 0 { 2 * slots[slot as usize].link() } else { none };
    let [a, b] = [2 * pair, 2 * pair + 1];
    let [order_a, order_b] = [order(a), order(b)];
    let second = order_b > order_a;
    let (largest, of_largest) = if second { (b, order_b) } else { (a, order_a) };
    let first = open(largest, of_largest);
    let is_open = of_largest >= 0;
    // [first, first + 1, b] or [a, first, first + 1].
    let [mut x, mut y, mut z] = if second { [a, first, first + 1] } else { [first, first + 1, b] };
    (x, y, z) = if is_open { (x, y, z) } else { (a, b, none) };

    let [order_x, order_y, order_z] = [order(x), order(y), order(z)];
    let (mut largest, mut of_largest) = if order_y > order_x { (1, order_y) } else { (0, order_x) };
    (largest, of_largest) = if order_z > of_largest { (2, order_z) } else { (largest, of_largest) };
    let slot = if largest == 0 {
        x
    } else if largest == 1 {
        y
    } else {
        z
    };
    let first = open(slot, of_largest);
    let is_open = of_largest >= 0;
    let opened = [
        if largest == 0 { first } else { x },
        if largest == 0 {
            first + 1
        } else if largest == 1 {
            first
        } else {
            y
        },
        if largest == 2 {
            first
        } else if largest == 1 {
            first + 1
        } else {
            y
        },
        if largest == 2 { first + 1 } else { z },
    ];
    let closed = [x, y, z, none];
    std::array::from_fn(|i| if is_open { opened[i] } else { closed[i] })
}
