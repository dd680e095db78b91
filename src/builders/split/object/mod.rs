//! The full-sweep SAH object split of a cut (paper 4.2, equation 1).

pub(crate) mod bins;
pub(crate) mod lanes;
pub(crate) mod ranks;

use crate::builders::binary::Node;
use crate::builders::split::cost::Weight;
use crate::builders::split::object::bins::Bins;
use crate::builders::split::spatial::anywhere;
use crate::geometry::Aabb;
use glam::Vec3A;
use lanes::Isa;
use ranks::RankSweep;

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

    /// Whether this one is to be preferred: it costs less, or comes before by axis and position.
    #[inline]
    pub fn is_before(&self, other: &Self) -> bool {
        self.cost < other.cost
            || (self.cost == other.cost
                && other.left > 0
                && (self.axis, self.left) < (other.axis, other.left))
    }

    /// What the boxes of both sides have in common; all of space if there is no split.
    pub fn overlap(&self, nodes: &[Node]) -> Aabb {
        if self.left == 0 {
            return Aabb::new(Vec3A::NEG_INFINITY, Vec3A::INFINITY);
        }
        let is_left = self.members(nodes);
        let mut sides = [Aabb::EMPTY; 2];
        for (i, node) in nodes.iter().enumerate() {
            let side = &mut sides[usize::from(is_left(i, node))];
            *side = side.union(node.bounds());
        }
        sides[0].intersection(sides[1])
    }

    /// Tells of every node of the cut, given with its position, whether it is on the left.
    pub fn members(&self, nodes: &[Node]) -> impl Fn(usize, &Node) -> bool + use<> {
        let (axis, last) = (self.axis, self.last);
        let border = center(&nodes[last], axis);
        move |i, node| {
            let own = center(node, axis);
            (own < border) | ((own == border) & (i <= last))
        }
    }
}

/// Twice the centroid's coordinate along an axis.
#[inline]
pub(crate) fn center(node: &Node, axis: usize) -> f32 {
    node.lower(axis) + node.upper(axis)
}

/// From this length on bins are faster than sorting, where ranks are not counted.
const LONG: usize = 24;

/// Memory for sweeps.
pub(crate) struct Sweep {
    /// Whether long cuts are binned.
    is_binned: bool,
    /// Whether the cut looked at last was.
    was_binned: bool,
    ranks: RankSweep,
    bins: Bins,
    /// Sort keys: (centroid << 32 | position in the cut).
    order: Vec<u64>,
    right_areas: Vec<f32>,
}

impl Default for Sweep {
    fn default() -> Self {
        Self {
            is_binned: true,
            was_binned: false,
            ranks: RankSweep::default(),
            bins: Bins::default(),
            order: Vec::new(),
            right_areas: Vec::new(),
        }
    }
}

impl Sweep {
    /// Sorts all cuts that are not short: what bins are measured by.
    pub fn plain() -> Self {
        Self { is_binned: false, ..Self::default() }
    }

    /// The split of `nodes` (two or more, with union `bounds`) of least cost; of equal ones the first by axis,
    /// then by position. Nodes are ordered along an axis by centroid, then by position in the cut. Cuts
    /// that are not long are swept by `isa`, which the processor must have.
    pub fn best(&mut self, isa: Isa, nodes: &[Node], bounds: Aabb, weight: Weight) -> ObjectSplit {
        let n = nodes.len();
        let limit = weight.limit(bounds.half_area(), n);
        self.was_binned = false;
        if let [a, b] = nodes {
            return two(a, b, limit);
        }
        if n <= isa.longest() {
            return lanes::best(isa, nodes, limit, weight);
        }
        if n <= ranks::longest(isa) {
            return self.ranks.best(isa, nodes, limit, weight);
        }
        if self.is_binned && n >= LONG {
            self.was_binned = true;
            return self.bins.best(nodes, limit, weight);
        }
        let mut best = ObjectSplit { cost: limit, ..ObjectSplit::NONE };
        for axis in 0..3 {
            let order = &mut self.order;
            order.clear();
            order.extend(
                nodes
                    .iter()
                    .enumerate()
                    .map(|(i, node)| u64::from(sortable(center(node, axis))) << 32 | i as u64),
            );
            order.sort_unstable();
            let node_at = |i: usize| nodes[order[i] as u32 as usize].bounds();
            self.right_areas.resize(n, 0.0);
            let mut right = Aabb::EMPTY;
            for i in (1..n).rev() {
                right = right.union(node_at(i));
                self.right_areas[i] = right.half_area();
            }
            let mut left = Aabb::EMPTY;
            for i in 1..n {
                left = left.union(node_at(i - 1));
                let cost = left.half_area() * weight.of(i) + self.right_areas[i] * weight.of(n - i);
                if cost < best.cost {
                    best = ObjectSplit { cost, axis, left: i, last: order[i - 1] as u32 as usize };
                }
            }
        }
        if best.left == 0 { ObjectSplit::NONE } else { best }
    }
}

impl Sweep {
    /// Bounds of the planes normal to `axis`, up to the second without it, at which a spatial split of the cut looked at
    /// last may cost less than `limit`; `None` if it cannot anywhere.
    pub fn planes_below(&self, axis: usize, limit: f32, weight: Weight) -> Option<[f32; 2]> {
        if self.was_binned { self.bins.planes_below(axis, limit, weight) } else { anywhere(axis, limit) }
    }
}

/// The one split of two nodes.
#[inline]
pub(crate) fn two(a: &Node, b: &Node, limit: f32) -> ObjectSplit {
    let cost = a.bounds().half_area() + b.bounds().half_area();
    let last = usize::from(center(b, 0) < center(a, 0));
    if cost < limit { ObjectSplit { cost, axis: 0, left: 1, last } } else { ObjectSplit::NONE }
}

/// Maps a float to an integer of the same order; both zeros to the same.
#[inline]
pub(crate) fn sortable(x: f32) -> u32 {
    let bits = (x + 0.0).to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3A;

    fn cubes(places: &[[f32; 3]]) -> (Vec<Node>, Aabb) {
        let nodes: Vec<Node> = places
            .iter()
            .map(|&p| Node::leaf(Aabb::new(Vec3A::from_array(p), Vec3A::from_array(p) + 1.0), 0, 1))
            .collect();
        let bounds = nodes.iter().map(Node::bounds).collect();
        (nodes, bounds)
    }

    #[test]
    fn two_clusters_are_parted_along_their_axis() {
        let (nodes, bounds) = cubes(&[[0., 9., 0.], [0., 0., 0.], [0., 10., 0.], [0., 1., 0.], [0., 2., 0.]]);
        let mut sweep = Sweep::default();
        let split = sweep.best(Isa::best(), &nodes, bounds, Weight::Nodes);
        // Left: three cubes in a row, half area 3 + 3 + 1 = 7; right: two, half area 2 + 2 + 1 = 5.
        assert_eq!(split, ObjectSplit { cost: 7.0 * 3.0 + 5.0 * 2.0, axis: 1, left: 3, last: 4 });
        let is_left = split.members(&nodes);
        let left: Vec<bool> = nodes.iter().enumerate().map(|(i, node)| is_left(i, node)).collect();
        assert_eq!(left, [false, true, false, true, true]);
    }

    #[test]
    fn boxes_all_alike_gain_nothing() {
        for n in [2, 3, 1000] {
            let (nodes, bounds) = cubes(&vec![[0.3, 0.7, 0.1]; n]);
            assert_eq!(Sweep::default().best(Isa::best(), &nodes, bounds, Weight::Nodes), ObjectSplit::NONE);
        }
    }

    #[test]
    fn sortable_keeps_the_order() {
        let values = [f32::NEG_INFINITY, -2.0, -1e-40, 0.0, 1e-40, 3.0, f32::INFINITY];
        assert!(values.windows(2).all(|w| sortable(w[0]) < sortable(w[1])));
        assert_eq!(sortable(-0.0), sortable(0.0));
    }
}
