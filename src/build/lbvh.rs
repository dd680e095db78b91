//! LBVH (Lauterbach et al. 2009) as the paper builds it in 4.7: Morton codes, a parallel sort, and a recursion
//! that finds each node's children where the highest bit of the code changes. Three changes: the sort is a
//! radix sort; boxes are united on the way back up instead of by atomic counters; and triangles that share a
//! code are parted by the middle of their own centroids' bounds, so that 32 bits suffice for any scene.

use super::binary::{BinaryTree, Node};
use super::morton_order::{Key, MortonOrder, part, prim};
use super::{Phase, Stopwatch};
use crate::geometry::{Aabb, Mesh};

/// Runs shorter than this are built by one thread.
pub(super) const SERIAL: usize = 1 << 12;

/// The auxiliary BVH with all it is made from; its memory is reused from build to build.
#[derive(Default)]
pub(super) struct Auxiliary {
    /// Boxes and codes.
    pub order: MortonOrder,
    /// The tree.
    pub tree: BinaryTree,
}

impl Auxiliary {
    /// Builds the LBVH of `mesh`.
    pub fn build(&mut self, mesh: &Mesh) -> Vec<Phase> {
        let mut watch = Stopwatch::start();
        self.order.sort(mesh, &mut watch);
        self.tree.make_room(mesh.len());
        let MortonOrder { primitives, keys, .. } = &mut self.order;
        self.tree.root = (!keys.is_empty())
            .then(|| Run { keys, first: 0, depth: 0 }.build(&primitives.boxes, &mut self.tree.pairs));
        watch.lap("auxiliary tree");
        watch.phases
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.order.bytes() + self.tree.bytes()
    }
}

/// A run of sorted keys that becomes a subtree. A split between positions s and s + 1 of the whole array puts
/// its pair at index s: each pair has a place of its own, and a run's pairs lie within it.
struct Run<'a> {
    keys: &'a mut [Key],
    /// Position of the run in the whole array.
    first: usize,
    depth: u32,
}

impl Run<'_> {
    /// Builds the subtree into `pairs`, the pairs of this run (one less than keys).
    fn build(self, boxes: &[Aabb], pairs: &mut [[Node; 2]]) -> Node {
        let Run { keys, first, depth } = self;
        if let &mut [key] = keys {
            return Node::leaf(boxes[prim(key) as usize], prim(key));
        }
        let len = keys.len();
        let split = part(keys, boxes, depth);
        let (left, right) = keys.split_at_mut(split);
        let (left_pairs, rest) = pairs.split_at_mut(split - 1);
        let (own, right_pairs) = rest.split_first_mut().expect("a run of n keys has n - 1 pairs");
        let left = Run { keys: left, first, depth: depth + 1 };
        let right = Run { keys: right, first: first + split, depth: depth + 1 };
        *own = if len < SERIAL {
            [left.build(boxes, left_pairs), right.build(boxes, right_pairs)]
        } else {
            rayon::join(|| left.build(boxes, left_pairs), || right.build(boxes, right_pairs)).into()
        };
        Node::inner(own, first + split - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(n: usize, place: impl Fn(usize) -> [f32; 3]) -> Mesh {
        let vertices = (0..n).flat_map(|i| {
            let [x, y, z] = place(i);
            [[x, y, z], [x + 1.0, y, z], [x, y + 1.0, z]]
        });
        Mesh::new(vertices.collect(), (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
            .unwrap()
            .0
    }

    fn walk(tree: &BinaryTree, node: &Node, seen: &mut Vec<u32>, depth: u32) -> u32 {
        if node.is_leaf() {
            seen.push(node.prim());
            return depth;
        }
        let children = tree.children(node);
        assert_eq!(node.count, children[0].count + children[1].count);
        assert!(children.iter().all(|child| node.bounds().contains(child.bounds())));
        children.iter().map(|child| walk(tree, child, seen, depth + 1)).max().unwrap()
    }

    #[test]
    fn every_triangle_is_a_leaf_and_depth_is_bounded() {
        type Placement = fn(usize) -> [f32; 3];
        let placements: [(&str, Placement); 4] = [
            ("spread", |i| [(i * 7919 % 1000) as f32, (i * 104_729 % 991) as f32, (i % 13) as f32]),
            ("identical", |_| [1.0, 2.0, 3.0]),
            ("geometric", |i| [2.0f32.powi(i as i32 % 120 - 60), 0.0, 0.0]),
            ("two clusters", |i| if i % 2 == 0 { [0.0, 0.0, i as f32 * 1e-6] } else { [1e15, 0.0, 0.0] }),
        ];
        for (name, place) in placements {
            for n in [1, 2, 3, 100, 5000] {
                let mesh = triangles(n, place);
                let mut auxiliary = Auxiliary::default();
                auxiliary.build(&mesh);
                let root = auxiliary.tree.root.unwrap();
                let mut seen = Vec::new();
                let depth = walk(&auxiliary.tree, &root, &mut seen, 0);
                seen.sort_unstable();
                assert_eq!(seen, (0..n as u32).collect::<Vec<_>>(), "{name}");
                assert!(depth <= 44 + 28, "{name}: {depth}");
            }
        }
    }

    #[test]
    fn memory_is_reused_for_a_smaller_mesh() {
        let mut auxiliary = Auxiliary::default();
        auxiliary.build(&triangles(1000, |i| [i as f32, 0.0, 0.0]));
        auxiliary.build(&triangles(10, |i| [i as f32, 0.0, 0.0]));
        assert_eq!(auxiliary.tree.root.unwrap().count, 10);
        auxiliary.build(&triangles(0, |_| [0.0; 3]));
        assert!(auxiliary.tree.root.is_none());
    }
}
