//! The two sides of a split.

use crate::builders::binary::Node;

/// A side of a split.
#[derive(Default)]
pub(crate) struct Side {
    /// Its nodes, in the order of the cut.
    pub nodes: Vec<Node>,
    /// References below them.
    pub count: u32,
}

impl Side {
    /// Forgets the nodes.
    pub fn clear(&mut self) {
        self.nodes.clear();
        self.count = 0;
    }

    /// Appends a node.
    #[inline]
    pub fn push(&mut self, node: Node) {
        self.count += node.count();
        self.nodes.push(node);
    }

    /// Parts the nodes of a cut.
    #[inline]
    pub fn part(sides: &mut [Self; 2], nodes: &[Node], is_left: impl Fn(usize, &Node) -> bool) {
        for (i, node) in nodes.iter().enumerate() {
            sides[usize::from(!is_left(i, node))].push(*node);
        }
    }
}
