//! The spatial split of a cut by a plane sweep over the boundaries of its nodes' boxes (paper 4.4, equation 3).

pub(crate) mod bins;
pub(crate) mod lanes;

use crate::builders::binary::Node;
use crate::builders::split::cost::Weight;
use crate::builders::split::object::lanes::Isa;
use crate::builders::split::object::sortable;
use crate::builders::split::spatial::bins::{Side, SpatialBins, above, below};
use crate::geometry::Aabb;
use lanes::Boxes;

/// The best spatial split of a cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SpatialSplit {
    /// `C_S` of equation 3 with half areas; infinite if there is no plane.
    pub cost: f32,
    /// Axis the plane is normal to.
    pub axis: usize,
    /// Where it is.
    pub plane: f32,
}

impl SpatialSplit {
    /// No split.
    pub const NONE: Self = Self { cost: f32::INFINITY, axis: 0, plane: 0.0 };

    /// Whether a box reaches left of the plane. One that lies in it does: it must be on one side.
    #[inline]
    pub fn on_left(&self, bounds: Aabb) -> bool {
        let (min, max) = (bounds.min[self.axis], bounds.max[self.axis]);
        min < self.plane || max <= self.plane
    }

    /// Whether a box reaches right of the plane.
    #[inline]
    pub fn on_right(&self, bounds: Aabb) -> bool {
        bounds.max[self.axis] > self.plane
    }

    /// The part of a box on the left.
    #[inline]
    pub fn left_of(&self, bounds: Aabb) -> Aabb {
        below(bounds, self.axis, self.plane)
    }

    /// The part of a box on the right.
    #[inline]
    pub fn right_of(&self, bounds: Aabb) -> Aabb {
        above(bounds, self.axis, self.plane)
    }
}

/// Memory for sweeps.
#[derive(Default)]
pub(crate) struct SpatialSweep {
    bins: SpatialBins,
    planes: Planes,
    lanes: Vec<f32>,
}

impl SpatialSweep {
    /// The spatial split of `nodes`, whose union is `bounds`, of least cost, if that is below `limit`; of equal
    /// ones the first by axis, then by plane. `isa` is what the processor has. `planes` tells of an axis between which
    /// planes, the second not among them, a split may cost less than a limit, if anywhere.
    pub fn below(
        &mut self,
        isa: Isa,
        limit: f32,
        nodes: &[Node],
        bounds: Aabb,
        weight: Weight,
        planes_below: impl Fn(usize, f32) -> Option<[f32; 2]>,
    ) -> SpatialSplit {
        let Self { bins, planes, lanes } = self;
        let mut best = SpatialSplit { cost: limit, ..SpatialSplit::NONE };
        if nodes.len() > lanes::longest(isa) {
            bins.fill(nodes, bounds);
            for axis in 0..3 {
                bins.each_below(axis, best.cost, weight, |bin, sides| {
                    planes.gather(axis, nodes, bins.members(axis, bin));
                    planes.sweep(axis, nodes, bounds, sides, weight, &mut best);
                    best.cost
                });
            }
        } else {
            let boxes = Boxes { nodes, bounds, weight };
            for axis in 0..3 {
                let Some([from, to]) = planes_below(axis, best.cost) else { continue };
                let range = [from.max(bounds.min[axis]), to.min(bounds.max[axis])];
                if let Some(range) = lanes::search(isa, axis, range, boxes, lanes, &mut best) {
                    let [before, after] = planes.gather_between(axis, nodes, range);
                    planes.sweep(axis, nodes, bounds, [&before, &after], weight, &mut best);
                }
            }
        }
        if best.cost < limit { best } else { SpatialSplit::NONE }
    }
}

/// No plane is known not to be cheap.
pub(crate) fn anywhere(_: usize, _: f32) -> Option<[f32; 2]> {
    Some([f32::NEG_INFINITY, f32::INFINITY])
}

/// The planes of a bin: the boundaries of nodes within it.
#[derive(Default)]
struct Planes {
    /// (sortable lower << 32 | sortable upper boundary, node) of nodes that begin in the bin, sorted.
    by_lower: Vec<(u64, u32)>,
    /// (sortable upper boundary, node) of nodes that end in it, sorted.
    by_upper: Vec<(u32, u32)>,
    /// `right[k]`: union of the nodes on the right of the bin and all but the first k that end in it.
    right: Vec<Aabb>,
}

impl Planes {
    /// Takes nodes by position, each with whether it begins and whether it ends in the bin.
    fn gather(&mut self, axis: usize, nodes: &[Node], members: impl Iterator<Item = (usize, [bool; 2])>) {
        self.by_lower.clear();
        self.by_upper.clear();
        for (i, [begins, ends]) in members {
            let (lower, upper) = (sortable(nodes[i].lower(axis)), sortable(nodes[i].upper(axis)));
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

    /// Takes the boundaries from one plane up to another, without the latter; returns the nodes on the left and on the
    /// right of all planes there.
    fn gather_between(&mut self, axis: usize, nodes: &[Node], [from, to]: [f32; 2]) -> [Side; 2] {
        self.by_lower.clear();
        self.by_upper.clear();
        let mut sides = [Side::EMPTY; 2];
        for (i, node) in nodes.iter().enumerate() {
            let (lower, upper) = (node.lower(axis), node.upper(axis));
            if lower < from {
                sides[0].add(node.bounds());
            } else if lower < to {
                self.by_lower.push((u64::from(sortable(lower)) << 32 | u64::from(sortable(upper)), i as u32));
            }
            if upper >= to {
                sides[1].add(node.bounds());
            } else if upper >= from {
                self.by_upper.push((sortable(upper), i as u32));
            }
        }
        self.by_lower.sort_unstable();
        self.by_upper.sort_unstable();
        sides
    }

    /// Looks for a plane cheaper than `best`; `sides` are the nodes on the left and on the right of them all.
    fn sweep(
        &mut self,
        axis: usize,
        nodes: &[Node],
        bounds: Aabb,
        [before, after]: [&Side; 2],
        weight: Weight,
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
            let at = sortable(plane);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::naive::splits;
    use glam::Vec3A;

    fn nodes(boxes: &[[f32; 2]]) -> (Vec<Node>, Aabb) {
        let nodes: Vec<Node> = boxes
            .iter()
            .map(|&[lo, hi]| Node::leaf(Aabb::new(Vec3A::new(lo, 0., 0.), Vec3A::new(hi, 1., 1.)), 0, 1))
            .collect();
        let bounds = nodes.iter().map(Node::bounds).collect();
        (nodes, bounds)
    }

    fn cheapest(nodes: &[Node], bounds: Aabb) -> SpatialSplit {
        let below =
            |isa| SpatialSweep::default().below(isa, f32::INFINITY, nodes, bounds, Weight::Nodes, anywhere);
        let cheapest = below(Isa::Scalar);
        Isa::available().for_each(|isa| assert_eq!(below(isa), cheapest, "{isa:?}, {} nodes", nodes.len()));
        cheapest
    }

    /// Equation 3 evaluated by its definition.
    fn by_definition(nodes: &[Node]) -> SpatialSplit {
        let boxes: Vec<Aabb> = nodes.iter().map(Node::bounds).collect();
        let best = splits::spatial(&boxes, Weight::Nodes);
        best.map_or(SpatialSplit::NONE, |(cost, plane)| SpatialSplit {
            cost,
            axis: plane.axis,
            plane: plane.at,
        })
    }

    #[test]
    fn a_wall_in_the_plane_is_on_exactly_one_side() {
        let split = SpatialSplit { cost: 0.0, axis: 0, plane: 2.0 };
        for (bounds, left, right) in [
            ([2., 2.], true, false),
            ([1., 2.], true, false),
            ([2., 3.], false, true),
            ([1., 3.], true, true),
        ] {
            let (nodes, _) = nodes(&[bounds]);
            assert_eq!(split.on_left(nodes[0].bounds()), left);
            assert_eq!(split.on_right(nodes[0].bounds()), right);
        }
    }

    #[test]
    fn the_sweep_finds_what_the_definition_says() {
        let (long, bounds) = nodes(&[[0., 10.], [0., 1.], [9., 10.], [5., 5.], [0., 4.]]);
        let best = cheapest(&long, bounds);
        assert_eq!(best, by_definition(&long));
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as f32 / 16.0
        };
        for n in (2..30).chain([33, 64, 100, 300]) {
            // Coarse grids have many equal planes; small boxes have cheap splits in a few places only.
            for (grain, size) in [(1.0, 1.0), (2.0, 0.3), (1.0 / 16.0, 0.05)] {
                let nodes: Vec<Node> = (0..n)
                    .map(|_| {
                        let mut point = || (Vec3A::new(random(), random(), random()) / grain).floor() * grain;
                        let (a, b) = (point(), point());
                        // Every third box is a wall.
                        let flat = if n % 3 == 0 { Vec3A::new(0.0, 1.0, 1.0) } else { Vec3A::ONE };
                        Node::leaf(Aabb::new(a.min(b), a.min(b) + (a.max(b) - a.min(b)) * flat * size), 0, 1)
                    })
                    .collect();
                let bounds = nodes.iter().map(Node::bounds).collect();
                let best = cheapest(&nodes, bounds);
                assert_eq!(best, by_definition(&nodes), "{n} nodes, {grain}, {size}");
                for (share, isa) in [0.5, 0.999, 1.0, 1.001, 2.0]
                    .into_iter()
                    .flat_map(|share| Isa::available().map(move |isa| (share, isa)))
                {
                    let limit = best.cost * share;
                    let below =
                        SpatialSweep::default().below(isa, limit, &nodes, bounds, Weight::Nodes, anywhere);
                    assert_eq!(below, if best.cost < limit { best } else { SpatialSplit::NONE });
                }
            }
        }
    }

    #[test]
    fn one_box_has_no_plane() {
        let (nodes, bounds) = nodes(&[[0., 1.]]);
        assert_eq!(cheapest(&nodes, bounds), SpatialSplit::NONE);
    }
}
