//! A run's tree made wide and written as a piece, by opening the largest child first (paper 4.5). What
//! [`super::top_down`] does for any builder, for one that knows all areas and leaves before.

use super::binary::Node;
use super::morton_order::{Key, reference};
use super::piece::{Piece, Subtree};
use super::references::References;
use super::run::Run;
use super::top_down::WIDTH;
use crate::bvh::{Link, TriangleBlock, WideNode};
use crate::geometry::Aabb;

/// The area of what is no node to open.
const CLOSED: f32 = -1.0;

/// Writes the tree below `root`, the one of `run`, whose leaves are quartets of `keys`.
pub(super) fn widen(
    root: &Node,
    run: &Run,
    keys: &[Key],
    references: &References<'_>,
    piece: &mut Piece,
) -> Subtree {
    // The leaves in order: no branch depends on how many triangles they have.
    piece.blocks.extend(run.leaves.windows(2).map(|leaf| {
        let [begin, end] = [leaf[0] as usize, leaf[1] as usize];
        let prims = std::array::from_fn(|i| references.prim(reference(keys[(begin + i).min(end - 1)])));
        TriangleBlock::of_first(end - begin, prims, references.mesh)
    }));
    let mut widen = Widen { subtrees: run.tree.pairs.as_flattened(), leaves: 0, nodes: &mut piece.nodes };
    Some((root.bounds(), widen.link(root)))
}

struct Widen<'a> {
    /// Siblings in a row.
    subtrees: &'a [Node],
    /// Leaves met: they are met in order.
    leaves: usize,
    nodes: &'a mut Vec<WideNode<WIDTH>>,
}

impl Widen<'_> {
    fn link(&mut self, subtree: &Node) -> Link {
        match subtree.pair() {
            Some(pair) => self.node(pair),
            None => {
                self.leaves += 1;
                Link::leaf(self.leaves - 1, 1)
            }
        }
    }

    /// Appends the wide nodes below a pair and the one above it.
    fn node(&mut self, pair: usize) -> Link {
        let (children, len) = self.children(pair);
        let mut boxes = [Aabb::EMPTY; WIDTH];
        let mut links = [Link::EMPTY; WIDTH];
        for slot in 0..len {
            let child = &self.subtrees[children[slot]];
            boxes[slot] = child.bounds();
            links[slot] = self.link(child);
        }
        self.nodes.push(WideNode::of_slots(boxes, links));
        Link::inner(self.nodes.len() - 1)
    }

    /// The children of the wide node over a pair, in order, and their number.
    fn children(&self, pair: usize) -> ([usize; WIDTH], usize) {
        let mut children = [2 * pair, 2 * pair + 1, 0, 0];
        let mut areas = [self.area(2 * pair), self.area(2 * pair + 1), CLOSED, CLOSED];
        for len in 2..WIDTH {
            let mut largest = 0;
            for i in 1..WIDTH - 1 {
                largest = if areas[i] > areas[largest] { i } else { largest };
            }
            let Some(pair) = self.subtrees[children[largest]].pair() else { return (children, len) };
            for i in (1..WIDTH).rev() {
                if i > largest {
                    children[i] = children[i - 1];
                    areas[i] = areas[i - 1];
                }
            }
            for (i, child) in [(largest, 2 * pair), (largest + 1, 2 * pair + 1)] {
                children[i] = child;
                areas[i] = self.area(child);
            }
        }
        (children, WIDTH)
    }

    /// Half the surface area of a subtree that may be opened.
    fn area(&self, subtree: usize) -> f32 {
        let subtree = &self.subtrees[subtree];
        if subtree.is_leaf() { CLOSED } else { subtree.bounds().half_area() }
    }
}
