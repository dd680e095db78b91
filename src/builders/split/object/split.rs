//! An object split: the nodes of a cut are ordered along an axis, and the first of them go to the left.

use crate::builders::binary::node::Node;

/// The best object split of a cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ObjectSplit {
    /// `C(i)` of equation 1 with half areas; infinite if no split gains anything.
    pub cost: f32,
    /// Axis along which the nodes are ordered.
    pub axis: usize,
    /// Nodes on the left.
    pub left: usize,
    /// Position in the cut of the last node on the left.
    pub last: usize,
}

impl ObjectSplit {
    /// No split.
    pub const NONE: Self = Self { cost: f32::INFINITY, axis: 0, left: 0, last: 0 };

    /// No split yet, where one must cost less than `limit`.
    #[inline]
    pub const fn below(limit: f32) -> Self {
        Self { cost: limit, ..Self::NONE }
    }

    /// [`ObjectSplit::NONE`] if no split was found.
    #[inline]
    pub fn or_none(self) -> Self {
        if self.left == 0 { Self::NONE } else { self }
    }

    /// Whether this split is preferred to another: it costs less, or the same and comes first by axis and position.
    #[inline]
    pub fn is_before(&self, other: &Self) -> bool {
        self.cost < other.cost
            || (self.cost == other.cost
                && other.left > 0
                && (self.axis, self.left) < (other.axis, other.left))
    }

    /// The only split of two nodes.
    #[inline]
    pub fn of_two(a: &Node, b: &Node, limit: f32) -> Self {
        let cost = a.bounds().half_area() + b.bounds().half_area();
        let last = usize::from(b.center2(0) < a.center2(0));
        if cost < limit { Self { cost, axis: 0, left: 1, last } } else { Self::NONE }
    }

    /// Tells of every node of the cut, given with its position, whether it is on the left.
    pub fn members(&self, nodes: &[Node]) -> impl Fn(usize, &Node) -> bool + use<> {
        let (axis, last) = (self.axis, self.last);
        let border = nodes[last].center2(axis);
        move |i, node| {
            let own = node.center2(axis);
            (own < border) | ((own == border) & (i <= last))
        }
    }
}
