//! From a binary tree to a wide one, by opening the largest child first (paper 4.5), and the builders that do
//! nothing more: the auxiliary LBVH itself.

use super::binary::{BinaryTree, Node};
use super::lbvh::Auxiliary;
use super::top_down::{self, Pool, QUARTET, TopDown};
use super::{Build, Builder, Counts, Stopwatch};
use crate::geometry::{Aabb, Mesh};

/// Collapses a binary tree: subtrees of at most four triangles become leaves.
pub(super) struct Collapse<'a>(pub &'a BinaryTree);

impl TopDown for Collapse<'_> {
    type Part = Node;
    type Scratch = ();

    fn count(&self, node: &Node) -> u32 {
        node.count
    }

    fn is_leaf(&self, node: &Node) -> bool {
        node.count <= QUARTET
    }

    fn half_area(&self, node: &Node) -> f32 {
        node.bounds().half_area()
    }

    fn split(&self, node: Node, (): &mut ()) -> [Option<Node>; 2] {
        self.0.children(&node).map(Some)
    }

    fn leaf(&self, node: Node, ids: &mut Vec<u32>, (): &mut ()) -> Aabb {
        self.gather(&node, ids);
        node.bounds()
    }
}

impl Collapse<'_> {
    fn gather(&self, node: &Node, ids: &mut Vec<u32>) {
        if node.is_leaf() {
            ids.push(node.prim());
        } else {
            self.0.children(node).iter().for_each(|child| self.gather(child, ids));
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
        let tree = &self.auxiliary.tree;
        let tree = top_down::build(&Collapse(tree), tree.root, mesh, &self.pool);
        watch.lap("nodes");
        phases.extend(watch.phases);
        let counts = Counts { auxiliary_nodes: 2 * mesh.len() as u64, ..Counts::default() };
        Build::finish(tree, phases, counts, self.auxiliary.bytes() + self.pool.bytes())
    }
}
