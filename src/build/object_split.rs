//! The full-sweep SAH object split of a cut (paper 4.2, equation 1).

use super::binary::Node;
use crate::geometry::Aabb;

/// The best object split of a cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ObjectSplit {
    /// `C(i)` of equation 1 with half areas; infinite if no split gains anything.
    pub cost: f32,
    /// Axis along which the nodes are ordered.
    pub axis: usize,
    /// Nodes on the left.
    pub left: usize,
}

impl ObjectSplit {
    /// No split.
    pub const NONE: Self = Self { cost: f32::INFINITY, axis: 0, left: 0 };
}

/// A split must cost less than this part of no split (`S n`) to count as a gain: among boxes all alike every
/// split costs `S n` but for rounding, and the first of them would peel off one node at a time.
pub(super) const GAIN: f32 = 1.0 - 1.0 / (1 << 20) as f32;

/// Memory for sweeps; after [`Sweep::best`] it holds the order of the nodes along each axis.
#[derive(Default)]
pub(super) struct Sweep {
    /// Sort keys along each axis: (centroid << 32 | position in the cut).
    orders: [Vec<u64>; 3],
    right_areas: Vec<f32>,
}

impl Sweep {
    /// The split of `nodes` (two or more, with union `bounds`) of least cost; of equal ones the first by axis,
    /// then by position.
    pub fn best(&mut self, nodes: &[Node], bounds: Aabb) -> ObjectSplit {
        let n = nodes.len();
        let limit = bounds.half_area() * n as f32 * GAIN;
        let mut best = ObjectSplit { cost: limit, ..ObjectSplit::NONE };
        for axis in 0..3 {
            let order = &mut self.orders[axis];
            order.clear();
            order.extend(
                nodes
                    .iter()
                    .enumerate()
                    .map(|(i, node)| u64::from(sortable(node.bounds().center2()[axis])) << 32 | i as u64),
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
                let cost = left.half_area() * i as f32 + self.right_areas[i] * (n - i) as f32;
                if cost < best.cost {
                    best = ObjectSplit { cost, axis, left: i };
                }
            }
        }
        if best.left == 0 { ObjectSplit::NONE } else { best }
    }

    /// Marks the positions in the cut of the nodes on the left of `split`.
    pub fn mark_left(&self, split: &ObjectSplit, is_left: &mut Vec<bool>) {
        let order = &self.orders[split.axis];
        is_left.clear();
        is_left.resize(order.len(), false);
        order[..split.left].iter().for_each(|&key| is_left[key as u32 as usize] = true);
    }
}

/// Maps a float to an integer of the same order; both zeros to the same.
#[inline]
pub(super) fn sortable(x: f32) -> u32 {
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
            .map(|&p| Node::leaf(Aabb::new(Vec3A::from_array(p), Vec3A::from_array(p) + 1.0), 0))
            .collect();
        let bounds = nodes.iter().map(Node::bounds).collect();
        (nodes, bounds)
    }

    #[test]
    fn two_clusters_are_parted_along_their_axis() {
        let (nodes, bounds) = cubes(&[[0., 9., 0.], [0., 0., 0.], [0., 10., 0.], [0., 1., 0.], [0., 2., 0.]]);
        let mut sweep = Sweep::default();
        let split = sweep.best(&nodes, bounds);
        // Left: three cubes in a row, half area 3 + 3 + 1 = 7; right: two, half area 2 + 2 + 1 = 5.
        assert_eq!(split, ObjectSplit { cost: 7.0 * 3.0 + 5.0 * 2.0, axis: 1, left: 3 });
        let mut is_left = Vec::new();
        sweep.mark_left(&split, &mut is_left);
        assert_eq!(is_left, [false, true, false, true, true]);
    }

    #[test]
    fn boxes_all_alike_gain_nothing() {
        for n in [2, 3, 1000] {
            let (nodes, bounds) = cubes(&vec![[0.3, 0.7, 0.1]; n]);
            assert_eq!(Sweep::default().best(&nodes, bounds), ObjectSplit::NONE);
        }
    }

    #[test]
    fn sortable_keeps_the_order() {
        let values = [f32::NEG_INFINITY, -2.0, -1e-40, 0.0, 1e-40, 3.0, f32::INFINITY];
        assert!(values.windows(2).all(|w| sortable(w[0]) < sortable(w[1])));
        assert_eq!(sortable(-0.0), sortable(0.0));
    }
}
