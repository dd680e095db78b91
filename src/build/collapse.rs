//! From a binary tree to a wide one, by opening the largest child first (paper 4.5), and the builder that does
//! nothing more: the auxiliary LBVH itself.

use super::binary::{BinaryTree, Node};
use super::lbvh::Auxiliary;
use super::top_down::{self, Pool, QUARTET, TopDown};
use super::{Build, Builder, Counts, Stopwatch};
use crate::geometry::{Aabb, Mesh};

/// From this depth of the binary tree on, triangles are halved by count: a chain of clusters must not make the
/// tree deeper than traversal stacks allow.
const MAX_DEPTH: u32 = 64;

/// Collapses a binary tree: subtrees of at most four triangles become leaves.
#[derive(Clone, Copy)]
pub(super) struct Collapse<'a> {
    /// The tree.
    pub tree: &'a BinaryTree,
    /// Boxes of the triangles.
    pub boxes: &'a [Aabb],
}

/// What is left to build.
pub(super) enum Part {
    /// A subtree at a depth of the binary tree.
    Subtree(Node, u32),
    /// Triangles of a subtree too deep, and their box.
    Triangles(Vec<u32>, Aabb),
}

impl Collapse<'_> {
    /// The whole tree.
    pub fn root(&self) -> Option<Part> {
        self.tree.root.map(|root| Part::Subtree(root, 0))
    }

    /// Appends the triangles below `node`.
    fn gather(&self, node: &Node, ids: &mut Vec<u32>) {
        if node.is_leaf() {
            ids.push(node.prim());
        } else {
            self.tree.children(node).iter().for_each(|child| self.gather(child, ids));
        }
    }

    fn triangles(&self, ids: Vec<u32>) -> Part {
        let bounds = ids.iter().map(|&id| self.boxes[id as usize]).collect();
        Part::Triangles(ids, bounds)
    }
}

impl TopDown for Collapse<'_> {
    type Part = Part;
    type Scratch = ();

    fn count(&self, part: &Part) -> u32 {
        match part {
            Part::Subtree(node, _) => node.count,
            Part::Triangles(ids, _) => ids.len() as u32,
        }
    }

    fn is_leaf(&self, part: &Part) -> bool {
        self.count(part) <= QUARTET
    }

    fn half_area(&self, part: &Part) -> f32 {
        match part {
            Part::Subtree(node, _) => node.bounds().half_area(),
            Part::Triangles(_, bounds) => bounds.half_area(),
        }
    }

    fn split(&self, part: Part, (): &mut ()) -> [Option<Part>; 2] {
        let mut ids = match part {
            Part::Subtree(node, depth) if depth < MAX_DEPTH => {
                return self.tree.children(&node).map(|child| Some(Part::Subtree(child, depth + 1)));
            }
            Part::Subtree(node, _) => {
                let mut ids = Vec::with_capacity(node.count as usize);
                self.gather(&node, &mut ids);
                ids
            }
            Part::Triangles(ids, _) => ids,
        };
        let right = ids.split_off(ids.len() / 2);
        [Some(self.triangles(ids)), Some(self.triangles(right))]
    }

    fn leaf(&self, part: Part, ids: &mut Vec<u32>, (): &mut ()) -> Aabb {
        match part {
            Part::Subtree(node, _) => {
                self.gather(&node, ids);
                node.bounds()
            }
            Part::Triangles(leaf, bounds) => {
                ids.extend(leaf);
                bounds
            }
        }
    }
}

/// Builds the auxiliary LBVH and nothing better.
#[derive(Default)]
pub struct Lbvh {
    auxiliary: Auxiliary,
    pool: Pool<()>,
}

impl Builder for Lbvh {
    fn name(&self) -> &'static str {
        "lbvh"
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!({ "code_bits": super::morton::BITS })
    }

    fn build(&mut self, mesh: &Mesh) -> Build {
        let mut phases = self.auxiliary.build(mesh);
        let mut watch = Stopwatch::start();
        let tree = Collapse { tree: &self.auxiliary.tree, boxes: &self.auxiliary.order.primitives.boxes };
        let tree = top_down::build(&tree, tree.root(), mesh, &self.pool);
        watch.lap("nodes");
        phases.extend(watch.phases);
        let counts = Counts { auxiliary_nodes: 2 * mesh.len() as u64, ..Counts::default() };
        Build::finish(tree, phases, counts, self.auxiliary.bytes() + self.pool.bytes())
    }
}
