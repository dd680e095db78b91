//! LBVH (Lauterbach et al. 2009) as the paper builds it in 4.7: Morton codes, a parallel sort, and a recursion
//! that finds each node's children where the highest bit of the code changes. Three changes: the sort is a
//! radix sort; boxes are united on the way back up instead of by atomic counters; and triangles that share a
//! code are parted by the middle of their own centroids' bounds, which is what further bits would say, so that
//! 32 bits suffice for any scene.

use super::binary::{BinaryTree, Node};
use super::morton::Quantizer;
use super::primitives::{GRAIN, Primitives};
use super::{Phase, Stopwatch, radix_sort};
use crate::geometry::{Aabb, Mesh};
use rayon::prelude::*;

/// Beyond this depth ranges are halved by count, so that no input makes the tree deeper than
/// `MAX_CODED_DEPTH` + 28 levels.
const MAX_CODED_DEPTH: u32 = 44;

/// Ranges smaller than this are built by one thread.
const SERIAL: usize = 1 << 12;

/// The auxiliary BVH with all it is made from; its memory is reused from build to build.
#[derive(Default)]
pub(super) struct Auxiliary {
    /// Boxes of the triangles.
    pub primitives: Primitives,
    /// The tree.
    pub tree: BinaryTree,
    keys: Vec<u64>,
    scratch: Vec<u64>,
}

impl Auxiliary {
    /// Builds the LBVH of `mesh`.
    pub fn build(&mut self, mesh: &Mesh) -> Vec<Phase> {
        let mut watch = Stopwatch::start();
        self.primitives.collect(mesh);
        watch.lap("boxes");
        self.sort_by_code();
        watch.lap("codes and sort");
        self.tree.pairs.resize(mesh.len().saturating_sub(1), [Node::ZERO; 2]);
        let boxes = &self.primitives.boxes;
        self.tree.root = (!self.keys.is_empty())
            .then(|| Range { keys: &mut self.keys, first: 0, depth: 0 }.build(boxes, &mut self.tree.pairs));
        watch.lap("auxiliary tree");
        watch.phases
    }

    /// Fills `keys` with (code << 32 | triangle), sorted.
    fn sort_by_code(&mut self) {
        let quantizer = Quantizer::new(self.primitives.centers);
        let boxes = &self.primitives.boxes;
        self.keys.resize(boxes.len(), 0);
        self.keys.par_chunks_mut(GRAIN).enumerate().for_each(|(chunk, keys)| {
            let first = chunk * GRAIN;
            for (i, key) in keys.iter_mut().enumerate() {
                *key = make_key(quantizer.code(boxes[first + i].center2()), (first + i) as u32);
            }
        });
        radix_sort::sort(&mut self.keys, &mut self.scratch);
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.primitives.boxes.capacity() * size_of::<Aabb>()
            + (self.keys.capacity() + self.scratch.capacity()) * size_of::<u64>()
            + self.tree.pairs.capacity() * size_of::<[Node; 2]>()
    }
}

fn make_key(code: u32, prim: u32) -> u64 {
    u64::from(code) << 32 | u64::from(prim)
}

fn code(key: u64) -> u32 {
    (key >> 32) as u32
}

fn id(key: u64) -> u32 {
    key as u32
}

/// A run of sorted keys that becomes a subtree. A split between positions s and s + 1 of the whole array puts
/// its pair at index s: each pair has a place of its own, and a range's pairs lie within it.
struct Range<'a> {
    keys: &'a mut [u64],
    /// Position of the range in the whole array.
    first: usize,
    depth: u32,
}

impl Range<'_> {
    /// Builds the subtree into `pairs`, the pairs of this range (one less than keys).
    fn build(self, boxes: &[Aabb], pairs: &mut [[Node; 2]]) -> Node {
        let Range { keys, first, depth } = self;
        if let &mut [key] = keys {
            return Node::leaf(boxes[id(key) as usize], id(key));
        }
        let split = if depth >= MAX_CODED_DEPTH {
            keys.len() / 2
        } else if code(keys[0]) == code(keys[keys.len() - 1]) {
            part_by_middle(keys, boxes)
        } else {
            highest_change(keys)
        };
        let len = keys.len();
        let (left, right) = keys.split_at_mut(split);
        let (left_pairs, rest) = pairs.split_at_mut(split - 1);
        let (own, right_pairs) = rest.split_first_mut().expect("a range of n keys has n - 1 pairs");
        let left = Range { keys: left, first, depth: depth + 1 };
        let right = Range { keys: right, first: first + split, depth: depth + 1 };
        *own = if len < SERIAL {
            [left.build(boxes, left_pairs), right.build(boxes, right_pairs)]
        } else {
            rayon::join(|| left.build(boxes, left_pairs), || right.build(boxes, right_pairs)).into()
        };
        Node::inner(own, first + split - 1)
    }
}

/// The first key whose code has the highest bit set in which the first and the last code differ.
fn highest_change(keys: &[u64]) -> usize {
    let differing = code(keys[0]) ^ code(keys[keys.len() - 1]);
    let bit = 1 << (31 - differing.leading_zeros());
    keys.partition_point(|&key| code(key) & bit == 0)
}

/// Reorders a run of equal codes: first those whose centroid lies before the middle of the longest edge of the
/// centroids' bounds. Returns their number; half of all where they do not lie apart.
fn part_by_middle(keys: &mut [u64], boxes: &[Aabb]) -> usize {
    let center = |key: u64| boxes[id(key) as usize].center2();
    let bounds = keys.iter().fold(Aabb::EMPTY, |bounds, &key| bounds.grow(center(key)));
    let axis = bounds.extent().max_position();
    let middle = bounds.center()[axis];
    let mut split = 0;
    for i in 0..keys.len() {
        if center(keys[i])[axis] < middle {
            keys.swap(i, split);
            split += 1;
        }
    }
    if (1..keys.len()).contains(&split) { split } else { keys.len() / 2 }
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
        let placements: [(&str, fn(usize) -> [f32; 3]); 4] = [
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
                assert!(depth <= MAX_CODED_DEPTH + 28, "{name}: {depth}");
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
