//! Paper 4.2: the object split of a cut, by its definition. Along each axis the nodes are sorted by centroid and swept
//! from both sides; the split of least cost by equation 1, `C(i) = S_L(i) n_L(i) + S_R(i) n_R(i)`,
//! is taken. Everything else in this folder finds the same split
//! faster.

use super::split::ObjectSplit;
use crate::builders::binary::node::Node;
use crate::builders::split::cost::{CountedBox, Weight};
use crate::geometry::ordered::ordered_bits;

/// Memory of sweeps.
#[derive(Default)]
pub(crate) struct FullSweep {
    /// Sort keys: (centroid << 32 | position in the cut).
    order: Vec<u64>,
    /// Half areas of the right sides.
    right_areas: Vec<f32>,
}

impl FullSweep {
    /// The split of `nodes` (two or more) of least cost below `limit`; of equal ones the first by axis, then by
    /// position. Nodes are ordered by centroid, then by position in the cut.
    pub fn best(&mut self, nodes: &[Node], limit: f32, weight: Weight) -> ObjectSplit {
        let mut best = ObjectSplit::below(limit);
        for axis in 0..3 {
            self.sweep(nodes, axis, 0..nodes.len(), [&CountedBox::EMPTY; 2], weight, &mut best);
        }
        best.or_none()
    }

    /// Sweeps along `axis` over the nodes at the positions `members`, where all other nodes lie before or after them in
    /// the order. Returns whether a split better than `best` was found.
    pub fn sweep(
        &mut self,
        nodes: &[Node],
        axis: usize,
        members: impl Iterator<Item = usize>,
        [before, after]: [&CountedBox; 2],
        weight: Weight,
        best: &mut ObjectSplit,
    ) -> bool {
        let Self { order, right_areas } = self;
        order.clear();
        order.extend(members.map(|i| u64::from(ordered_bits(nodes[i].center2(axis))) << 32 | i as u64));
        order.sort_unstable();
        let node_at = |i: usize| order[i] as u32 as usize;
        right_areas.resize(order.len(), 0.0);
        let mut right = after.bounds;
        for i in (1..order.len()).rev() {
            right = right.union(nodes[node_at(i)].bounds());
            right_areas[i] = right.half_area();
        }
        let (mut left, mut is_found) = (before.bounds, false);
        for i in 1..order.len() {
            left = left.union(nodes[node_at(i - 1)].bounds());
            let on_left = before.count as usize + i;
            let cost =
                left.half_area() * weight.of(on_left) + right_areas[i] * weight.of(nodes.len() - on_left);
            let split = ObjectSplit { cost, axis, left: on_left, last: node_at(i - 1) };
            if split.is_before(best) {
                *best = split;
                is_found = true;
            }
        }
        is_found
    }
}
