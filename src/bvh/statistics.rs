//! Costs and counts of a tree: the SAH cost of Table 1's caption by Embree's formula, and sizes.

use super::limits::MAX_LEAF_BLOCKS;
use super::{Child, LeafBlock, Link, WideBvh};
use crate::geometry::Mesh;

/// Counts and costs of a tree.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Statistics {
    /// SAH cost with c_T = c_I = 1, a leaf counting its blocks: the sum over inner nodes of their area and
    /// over leaves of area times blocks, relative to the area of the whole. Embree prints the same.
    pub sah: f64,
    /// End-point overlap (Aila, Karras, Laine 2013), see [`super::epo()`].
    pub epo: f64,
    /// Inner nodes reached.
    pub nodes: usize,
    /// Leaves reached.
    pub leaves: usize,
    /// Leaf blocks reached.
    pub blocks: usize,
    /// Triangle references in leaves.
    pub references: usize,
    /// References per triangle of the mesh: 1 without spatial splits.
    pub references_per_triangle: f64,
    /// Levels of inner nodes; 0 if the root is a leaf.
    pub depth: usize,
    /// Used child slots of inner nodes, 0 to 1.
    pub node_fill: f64,
    /// Used lanes of leaf blocks, 0 to 1.
    pub leaf_fill: f64,
    /// Bytes of nodes and leaf blocks.
    pub bytes: usize,
    /// Leaves by number of blocks, 1 first.
    pub leaves_by_blocks: [usize; MAX_LEAF_BLOCKS],
}

impl Statistics {
    /// Measures `tree`, a valid tree over `mesh`.
    pub fn of<const N: usize>(tree: &WideBvh<N>, mesh: &Mesh) -> Self {
        let counts = Counter::of(tree);
        let ratio = |a: usize, b: usize| if b == 0 { 0.0 } else { a as f64 / b as f64 };
        Self {
            sah: counts.sah(tree),
            epo: super::epo(tree, mesh),
            nodes: counts.nodes,
            leaves: counts.leaves_by_blocks.iter().sum(),
            blocks: counts.blocks,
            references: counts.references,
            references_per_triangle: ratio(counts.references, mesh.len()),
            depth: counts.depth,
            node_fill: ratio(counts.children, N * counts.nodes),
            leaf_fill: ratio(counts.references, 4 * counts.blocks),
            bytes: tree.bytes(),
            leaves_by_blocks: counts.leaves_by_blocks,
        }
    }
}

impl<const N: usize, B: LeafBlock> WideBvh<N, B> {
    /// Levels of inner nodes, as [`Statistics::depth`]; 0 if the root is a leaf. The links must form a tree, as
    /// [`WideBvh::validate`] finds.
    pub fn depth(&self) -> usize {
        Counter::of(self).depth
    }
}

/// SAH cost alone, as [`Statistics::sah`]. The links must form a tree, as [`WideBvh::validate`] finds.
pub fn sah_cost<const N: usize, B: LeafBlock>(tree: &WideBvh<N, B>) -> f64 {
    Counter::of(tree).sah(tree)
}

#[derive(Default)]
struct Counter {
    cost: f64,
    nodes: usize,
    children: usize,
    blocks: usize,
    references: usize,
    depth: usize,
    leaves_by_blocks: [usize; MAX_LEAF_BLOCKS],
}

impl Counter {
    fn of<const N: usize, B: LeafBlock>(tree: &WideBvh<N, B>) -> Self {
        let mut counts = Self::default();
        counts.visit(tree, tree.root, f64::from(tree.bounds.half_area()), 0);
        counts
    }

    fn sah<const N: usize, B: LeafBlock>(&self, tree: &WideBvh<N, B>) -> f64 {
        let whole = f64::from(tree.bounds.half_area());
        match tree.root.get() {
            Child::Empty => 0.0,
            // A line or point has no area: by convention the plain counts.
            _ if whole == 0.0 => (self.nodes + self.blocks) as f64,
            _ => self.cost / whole,
        }
    }

    fn visit<const N: usize, B: LeafBlock>(
        &mut self,
        tree: &WideBvh<N, B>,
        link: Link,
        area: f64,
        depth: usize,
    ) {
        match link.get() {
            Child::Empty => {}
            Child::Inner(index) => {
                self.nodes += 1;
                self.cost += area;
                self.depth = self.depth.max(depth + 1);
                for (bounds, child) in tree.nodes[index].children() {
                    self.children += 1;
                    self.visit(tree, child, f64::from(bounds.half_area()), depth + 1);
                }
            }
            Child::Leaf { first, count } => {
                self.blocks += count;
                self.cost += area * count as f64;
                self.references += tree.leaf_ids(first, count).count();
                // Trees that were not validated may have longer ones.
                self.leaves_by_blocks[count.min(MAX_LEAF_BLOCKS) - 1] += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Bvh4, TriangleBlock, WideNode};
    use crate::geometry::Aabb;
    use glam::Vec3A;

    #[test]
    fn cost_of_a_tree_by_hand() {
        // Two unit-cube leaves of one and two blocks at both ends of a 4 x 1 x 1 box:
        // half areas 3, 3 and 4*2 + 1 = 9, so 1 + (3*1 + 3*2) / 9 = 2.
        let cube = |x: f32| Aabb::new(Vec3A::new(x, 0.0, 0.0), Vec3A::new(x + 1.0, 1.0, 1.0));
        let mut node = WideNode::<4>::EMPTY;
        node.set(0, cube(0.0), Link::leaf(0, 1));
        node.set(1, cube(3.0), Link::leaf(1, 2));
        let tree = Bvh4 {
            root: Link::inner(0),
            bounds: cube(0.0).union(cube(3.0)),
            nodes: vec![node],
            blocks: vec![TriangleBlock::EMPTY; 3],
        };
        assert_eq!((sah_cost(&tree), tree.depth()), (2.0, 1));
        let (mesh, _) = Mesh::new(vec![], vec![]).unwrap();
        let statistics = Statistics::of(&tree, &mesh);
        assert_eq!((statistics.sah, statistics.nodes, statistics.leaves, statistics.blocks), (2.0, 1, 2, 3));
        assert_eq!((statistics.depth, statistics.node_fill), (1, 0.5));
    }

    #[test]
    fn nothing_costs_nothing() {
        assert_eq!(sah_cost(&Bvh4::default()), 0.0);
    }
}
