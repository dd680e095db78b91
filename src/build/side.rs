//! The two sides of a split: lists of nodes that stay where they are.

use super::binary::Node;
use super::cut::Cut;

/// A side of a split.
#[derive(Default)]
pub(super) struct Side {
    /// Places of its nodes in the arena, ascending.
    pub places: Vec<u32>,
    /// References below them.
    pub count: u32,
}

impl Side {
    /// Forgets the nodes.
    pub fn clear(&mut self) {
        self.places.clear();
        self.count = 0;
    }

    /// Appends the node at a place.
    #[inline]
    pub fn push(&mut self, place: usize, node: &Node) {
        self.places.push(place as u32);
        self.count += node.count();
    }

    /// Parts the nodes of a cut. Nobody can guess the side of a node, and so there is no branch.
    #[inline]
    pub fn part(sides: &mut [Self; 2], cut: &Cut, nodes: &[Node], is_left: impl Fn(usize, &Node) -> bool) {
        let [left, right] = sides;
        left.places.resize(nodes.len(), 0);
        right.places.resize(nodes.len(), 0);
        let mut on_left = 0;
        for (i, node) in nodes.iter().enumerate() {
            let place = cut.first + i as u32;
            left.places[on_left] = place;
            right.places[i - on_left] = place;
            let is_left = is_left(i, node);
            on_left += usize::from(is_left);
            left.count += node.count() * u32::from(is_left);
        }
        left.places.truncate(on_left);
        right.places.truncate(nodes.len() - on_left);
        right.count = cut.count - left.count;
    }
}
