//! Splits whose sides are weighed by the triangles below their nodes in place of the nodes (Hunt, Mark, Fussell
//! 2007): the alternative to equations 1 and 3 that the paper compares with in 4.2. An experiment, in plain code:
//! what it says is the quality of trees, not the time of builds.

use super::cost::{CountedBox, GAIN, Weight};
use super::object::split::ObjectSplit;
use super::spatial::split::SpatialSplit;
use crate::builders::binary::node::Node;
use crate::geometry::Aabb;
use crate::geometry::ordered::ordered_bits;

/// A node, which counts as many as it has triangles.
fn counted(node: &Node) -> CountedBox {
    CountedBox { bounds: node.bounds(), count: node.count() }
}

/// What no split costs: the half area of all nodes times their triangles.
pub(crate) fn whole(area: f32, nodes: &[Node]) -> f32 {
    area * nodes.iter().map(|node| u64::from(node.count())).sum::<u64>() as f32
}

/// The object split of least cost, as [`super::object::full_sweep`] finds it for nodes.
pub(crate) fn object(nodes: &[Node], area: f32) -> ObjectSplit {
    let mut best = ObjectSplit::below(whole(area, nodes) * GAIN);
    for axis in 0..3 {
        let mut order: Vec<usize> = (0..nodes.len()).collect();
        // Zeros of either sign are one place, as for whoever divides the nodes.
        order.sort_by_key(|&i| ordered_bits(nodes[i].center2(axis)));
        let right = unions_from(order.iter().map(|&i| &nodes[i]));
        let mut left = CountedBox::EMPTY;
        for i in 1..nodes.len() {
            let last = order[i - 1];
            left = left.union(counted(&nodes[last]));
            let cost = left.cost(Weight::Nodes) + right[i].cost(Weight::Nodes);
            if cost < best.cost {
                best = ObjectSplit { cost, axis, left: i, last };
            }
        }
    }
    best.or_none()
}

/// The spatial split of least cost below `limit`, as [`super::spatial::plane_sweep`] finds it for nodes.
pub(crate) fn spatial(nodes: &[Node], bounds: Aabb, limit: f32) -> SpatialSplit {
    let mut best = SpatialSplit { cost: limit, ..SpatialSplit::NONE };
    for axis in 0..3 {
        let mut planes: Vec<f32> =
            nodes.iter().flat_map(|node| [node.lower(axis), node.upper(axis)]).collect();
        planes.retain(|&plane| bounds.min[axis] < plane && plane < bounds.max[axis]);
        planes.sort_by(f32::total_cmp);
        planes.dedup();
        // On the left of a plane are nodes that begin before it, or begin and end in it; on the right those that end
        // beyond it.
        let mut by_lower: Vec<&Node> = nodes.iter().collect();
        by_lower.sort_by(|a, b| {
            a.lower(axis).total_cmp(&b.lower(axis)).then(a.upper(axis).total_cmp(&b.upper(axis)))
        });
        let mut by_upper: Vec<&Node> = nodes.iter().collect();
        by_upper.sort_by(|a, b| a.upper(axis).total_cmp(&b.upper(axis)));
        let right = unions_from(by_upper.iter().copied());
        let (mut left, mut begun, mut ended) = (CountedBox::EMPTY, 0, 0);
        for plane in planes {
            let split = SpatialSplit { cost: 0.0, axis, plane };
            while begun < nodes.len() && split.on_left(by_lower[begun].bounds()) {
                left = left.union(counted(by_lower[begun]));
                begun += 1;
            }
            while ended < nodes.len() && !split.on_right(by_upper[ended].bounds()) {
                ended += 1;
            }
            let right = right[ended];
            if left.count == 0 || right.count == 0 {
                continue;
            }
            let cost = split.left_of(left.bounds).half_area() * left.count as f32
                + split.right_of(right.bounds).half_area() * right.count as f32;
            if cost < best.cost {
                best = SpatialSplit { cost, ..split };
            }
        }
    }
    if best.cost < limit { best } else { SpatialSplit::NONE }
}

/// All nodes from each on.
fn unions_from<'a>(nodes: impl DoubleEndedIterator<Item = &'a Node>) -> Vec<CountedBox> {
    let mut all = vec![CountedBox::EMPTY];
    all.extend(nodes.rev().scan(CountedBox::EMPTY, |all, node| {
        *all = all.union(counted(node));
        Some(*all)
    }));
    all.reverse();
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::split::object::strategy::ObjectSweep;
    use crate::builders::split::spatial::strategy::SpatialSweep;
    use crate::builders::testing::for_each_cut;
    use crate::simd::Isa;

    /// Where every node is of one triangle, triangles and nodes are the same.
    #[test]
    fn nodes_of_one_triangle_each_are_split_as_by_nodes() {
        let (mut by_nodes, mut planes) = (ObjectSweep::default(), SpatialSweep::default());
        for_each_cut(|nodes, bounds| {
            let expected = by_nodes.find(Isa::Scalar, nodes, bounds, Weight::Nodes).0;
            // Two nodes have a single split, whatever the axis.
            if nodes.len() > 2 {
                assert_eq!(object(nodes, bounds.half_area()), expected);
            }
            let limit = Weight::Nodes.limit(bounds.half_area(), nodes.len());
            let expected = planes.find(Isa::Scalar, limit, (nodes, bounds), Weight::Nodes, None);
            assert_eq!(spatial(nodes, bounds, limit), expected);
        });
    }

    #[test]
    fn many_triangles_are_kept_in_small_boxes() {
        let at = |x: f32| Aabb::new(glam::Vec3A::splat(x), glam::Vec3A::splat(x + 1.0));
        let nodes: Vec<Node> = [(0.0, 1), (1.5, 1), (3.0, 1), (4.5, 100)]
            .into_iter()
            .enumerate()
            .map(|(i, (x, count))| Node::leaf(at(x), 200 * i, count))
            .collect();
        let bounds: Aabb = nodes.iter().map(Node::bounds).collect();
        assert_eq!(object(&nodes, bounds.half_area()).left, 3);
        assert_eq!(ObjectSweep::default().find(Isa::Scalar, &nodes, bounds, Weight::Nodes).0.left, 2);
    }
}
