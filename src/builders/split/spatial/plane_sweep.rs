//! Paper 4.4: the spatial split of a cut, by its definition: a plane sweep along each axis over the boundaries of the
//! nodes' boxes; the plane of least cost by equation 3 is taken. Everything else in this folder finds the same split
//! faster.

use super::split::SpatialSplit;
use crate::builders::binary::node::Node;
use crate::builders::split::cost::{CountedBox, Weight};
use crate::geometry::Aabb;
use crate::geometry::ordered::ordered_bits;

/// A cut to be split.
#[derive(Clone, Copy)]
pub(crate) struct SpatialCut<'a> {
    /// Its nodes.
    pub nodes: &'a [Node],
    /// Their union.
    pub bounds: Aabb,
    /// How they are counted.
    pub weight: Weight,
}

/// Planes to sweep over: boundaries of some nodes.
#[derive(Default)]
pub(crate) struct PlaneSweep {
    /// (lower << 32 | upper boundary, node) of nodes that begin at these planes, sorted.
    by_lower: Vec<(u64, u32)>,
    /// (upper boundary, node) of nodes that end at these planes, sorted.
    by_upper: Vec<(u32, u32)>,
    /// `right[k]`: union of the nodes right of all planes and all but the first k that end at one.
    right: Vec<Aabb>,
}

impl PlaneSweep {
    /// Replaces `best` by the split of least cost, if that is less; of equal ones the first by axis, then by plane.
    pub fn improve(&mut self, boxes: SpatialCut<'_>, best: &mut SpatialSplit) {
        for axis in 0..3 {
            let members = (0..boxes.nodes.len()).map(|i| (i, [true; 2]));
            self.improve_among(axis, boxes, members, [&CountedBox::EMPTY; 2], best);
        }
    }

    /// As [`PlaneSweep::improve`] along one axis, among the boundaries of `members`: positions of nodes, with whether
    /// the lower and the upper boundary is one of the planes. `sides` are the nodes on the left and on the right of all
    /// planes.
    pub fn improve_among(
        &mut self,
        axis: usize,
        boxes: SpatialCut<'_>,
        members: impl Iterator<Item = (usize, [bool; 2])>,
        sides: [&CountedBox; 2],
        best: &mut SpatialSplit,
    ) {
        self.gather(axis, boxes.nodes, members);
        self.sweep(axis, boxes, sides, best);
    }

    /// As [`PlaneSweep::improve`] along one axis, among the planes of a range without its end.
    pub fn improve_between(
        &mut self,
        axis: usize,
        boxes: SpatialCut<'_>,
        [from, to]: [f32; 2],
        best: &mut SpatialSplit,
    ) {
        let mut sides = [CountedBox::EMPTY; 2];
        let members = boxes.nodes.iter().enumerate().map(|(i, node)| {
            let (lower, upper) = (node.lower(axis), node.upper(axis));
            if lower < from {
                sides[0].add(node.bounds());
            }
            if upper >= to {
                sides[1].add(node.bounds());
            }
            (i, [lower, upper].map(|plane| from <= plane && plane < to))
        });
        self.gather(axis, boxes.nodes, members);
        self.sweep(axis, boxes, [&sides[0], &sides[1]], best);
    }

    fn gather(&mut self, axis: usize, nodes: &[Node], members: impl Iterator<Item = (usize, [bool; 2])>) {
        self.by_lower.clear();
        self.by_upper.clear();
        for (i, [begins, ends]) in members {
            let (lower, upper) = (ordered_bits(nodes[i].lower(axis)), ordered_bits(nodes[i].upper(axis)));
            if begins {
                self.by_lower.push((u64::from(lower) << 32 | u64::from(upper), i as u32));
            }
            if ends {
                self.by_upper.push((upper, i as u32));
            }
        }
        self.by_lower.sort_unstable();
        self.by_upper.sort_unstable();
    }

    /// Sweeps over the gathered planes for one cheaper than `best`; `before` and `after` are the nodes on the left
    /// and on the right of all of them.
    fn sweep(
        &mut self,
        axis: usize,
        SpatialCut { nodes, bounds, weight }: SpatialCut<'_>,
        [before, after]: [&CountedBox; 2],
        best: &mut SpatialSplit,
    ) {
        let Self { by_lower, by_upper, right } = self;
        let (begins, ends) = (by_lower.len(), by_upper.len());
        right.resize(ends + 1, Aabb::EMPTY);
        right[ends] = after.bounds;
        for k in (0..ends).rev() {
            right[k] = right[k + 1].union(nodes[by_upper[k].1 as usize].bounds());
        }
        let mut left = before.bounds;
        // Of those that begin here: how many begin left of the plane, or begin and end in it. Of those that end
        // here: how many end left of it or in it.
        let (mut begun, mut ended) = (0, 0);
        let (mut next_lower, mut next_upper) = (0, 0);
        loop {
            // The next plane: the least boundary not yet looked at.
            let lower = by_lower.get(next_lower).map(|&(_, i)| nodes[i as usize].lower(axis));
            let upper = by_upper.get(next_upper).map(|&(_, i)| nodes[i as usize].upper(axis));
            let plane = match (lower, upper) {
                (Some(lower), Some(upper)) => lower.min(upper),
                (Some(plane), None) | (None, Some(plane)) => plane,
                (None, None) => break,
            };
            let at = ordered_bits(plane);
            while next_lower < begins && (by_lower[next_lower].0 >> 32) as u32 <= at {
                next_lower += 1;
            }
            while next_upper < ends && by_upper[next_upper].0 <= at {
                next_upper += 1;
                ended = next_upper;
            }
            // Left of the plane is what begins before it, or begins and ends in it.
            let reach = u64::from(at) << 32 | u64::from(at);
            while begun < begins && by_lower[begun].0 <= reach {
                left = left.union(nodes[by_lower[begun].1 as usize].bounds());
                begun += 1;
            }
            let on_left = before.count as usize + begun;
            let on_right = after.count as usize + ends - ended;
            if on_left == 0 || on_right == 0 || plane <= bounds.min[axis] || plane >= bounds.max[axis] {
                continue;
            }
            let split = SpatialSplit { cost: 0.0, axis, plane };
            let cost = split.left_of(left).half_area() * weight.of(on_left)
                + split.right_of(right[ended]).half_area() * weight.of(on_right);
            if cost < best.cost {
                *best = SpatialSplit { cost, ..split };
            }
        }
    }
}
