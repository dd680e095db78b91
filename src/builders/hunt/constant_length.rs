//! The rule of constant length: a partial sort by area, then the largest nodes are opened (paper 5).

use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::phr::cut::{CutBuilder, Side};
use crate::builders::phr::policy::CutPolicy;
use crate::geometry::Aabb;

/// Cuts of this many nodes, as far as there are enough. There are no spatial splits: nothing is clipped.
pub(crate) struct ConstantLength(pub usize);

impl CutPolicy for ConstantLength {
    const KEEPS_SINGLE_NODES: bool = false;

    fn refine(&self, tree: &BinaryTree, _: &Aabb, _: u32, side: &mut Side, refined: &mut CutBuilder<'_>) {
        let Side { nodes, count, keys, refined: opened } = side;
        if *count as usize <= self.0 {
            nodes.iter().for_each(|node| push_leaves(tree, node, refined));
            return;
        }
        // Opening a node makes a cut one longer; several rounds are needed after an uneven split. There are more
        // references than nodes wanted, and so always nodes to open.
        while nodes.len() < self.0 {
            keys.clear();
            keys.extend(nodes.iter().map(area_key));
            let inner = keys.iter().filter(|&&key| key > LEAF).count();
            let wanted = (self.0 - nodes.len()).min(inner);
            let Largest { least, mut equal } = Largest::of(keys, wanted, inner);
            opened.clear();
            for (&node, &key) in nodes.iter().zip(&*keys) {
                let is_least = key == least && equal > 0;
                equal -= usize::from(is_least);
                if key > least || is_least {
                    opened.extend(tree.children(&node));
                } else {
                    opened.push(node);
                }
            }
            std::mem::swap(nodes, opened);
        }
        nodes.iter().for_each(|&node| refined.push(node));
    }
}

/// The key of a leaf, which cannot be opened: less than all others.
const LEAF: i32 = i32::MIN;

/// Integers in the total order of half areas.
fn area_key(node: &Node) -> i32 {
    let bits = node.bounds().half_area().to_bits() as i32;
    if node.is_leaf() { LEAF } else { bits ^ (bits >> 31 & i32::MAX) }
}

/// Appends the leaves below `node`, in order.
fn push_leaves(tree: &BinaryTree, node: &Node, refined: &mut CutBuilder<'_>) {
    if node.is_leaf() {
        refined.push(*node);
    } else {
        tree.children(node).iter().for_each(|child| push_leaves(tree, child, refined));
    }
}

/// The largest of some keys: those greater than `least`, and the first `equal` of those that equal it.
#[derive(Debug, PartialEq)]
struct Largest {
    least: i32,
    equal: usize,
}

impl Largest {
    /// The `wanted` largest, one or more, of the `inner` keys that are no leaf's. The least of them is found by
    /// bisection: counting takes no branch that depends on a key.
    fn of(keys: &[i32], wanted: usize, inner: usize) -> Self {
        let not_below = |least: i32| keys.iter().map(|&key| u32::from(key >= least)).sum::<u32>() as usize;
        // Not fewer than wanted are at least `low`, and fewer at least `high`.
        let (mut low, mut found) = (LEAF + 1, inner);
        let (mut high, mut above) = (i32::MAX, 0);
        while found > wanted && high > low + 1 {
            let middle = i32::midpoint(low, high);
            match not_below(middle) {
                count if count < wanted => (high, above) = (middle, count),
                count => (low, found) = (middle, count),
            }
        }
        Self { least: low, equal: wanted - above }
    }
}
