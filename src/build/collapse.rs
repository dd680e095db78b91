//! From a binary tree to a wide one, by opening the largest child first (paper 4.5), and the builder that does
//! nothing more: the auxiliary LBVH itself.

use super::binary::{BinaryTree, Node};
use super::lbvh::Auxiliary;
use super::morton_order::{Key, reference};
use super::references::References;
use super::top_down::{self, Kind, Memory, QUARTET, TopDown};
use super::{Build, Builder, Counts, Stopwatch};
use crate::bvh::Bvh4;
use crate::geometry::{Aabb, Mesh};

/// From this depth of the binary tree on, references are halved by count: a chain of clusters must not make the
/// tree deeper than traversal stacks allow.
const MAX_DEPTH: u32 = 64;

/// Collapses a binary tree: subtrees of at most four references become leaves.
#[derive(Clone, Copy)]
pub(super) struct Collapse<'a> {
    /// The tree.
    pub tree: &'a BinaryTree,
    /// References in the order that the leaves' positions mean.
    pub keys: &'a [Key],
    /// What they refer to.
    pub references: References<'a>,
}

/// What is left to build.
#[derive(Clone)]
pub(super) enum Part {
    /// A subtree at a depth of the binary tree.
    Subtree(Node, u32),
    /// References of a subtree too deep, and their box.
    References(Vec<u32>, Aabb),
}

impl Collapse<'_> {
    /// The whole tree.
    pub fn root(&self) -> Option<Part> {
        self.tree.root.map(|root| Part::Subtree(root, 0))
    }

    /// Appends the references below `node`.
    fn gather(&self, node: &Node, ids: &mut Vec<u32>) {
        if node.is_leaf() {
            ids.extend(self.keys[node.run()].iter().map(|&key| reference(key)));
        } else {
            self.tree.children(node).iter().for_each(|child| self.gather(child, ids));
        }
    }

    fn part(&self, ids: Vec<u32>) -> Part {
        let bounds = ids.iter().map(|&id| self.references.bounds(id)).collect();
        Part::References(ids, bounds)
    }
}

impl TopDown for Collapse<'_> {
    type Seed = Part;
    type Part = Part;
    type Scratch = ();

    fn plant(&self, seed: Part, (): &mut ()) -> Part {
        seed
    }

    fn lift(&self, part: &Part, (): &()) -> Part {
        part.clone()
    }

    fn count(&self, part: &Part) -> u32 {
        match part {
            Part::Subtree(node, _) => node.count,
            Part::References(ids, _) => ids.len() as u32,
        }
    }

    fn half_area(&self, part: &Part) -> f32 {
        match part {
            Part::Subtree(node, _) => node.bounds().half_area(),
            Part::References(_, bounds) => bounds.half_area(),
        }
    }

    fn kind(&self, part: &Part) -> Kind {
        if self.count(part) <= QUARTET { Kind::Leaf } else { Kind::Inner }
    }

    fn split(&self, part: &Part, (): &mut ()) -> [Option<Part>; 2] {
        let mut ids = match part {
            Part::Subtree(node, depth) if *depth < MAX_DEPTH => {
                return self.tree.children(node).map(|child| {
                    self.tree.prefetch(&child);
                    Some(Part::Subtree(child, depth + 1))
                });
            }
            Part::Subtree(node, _) => {
                let mut ids = Vec::with_capacity(node.count as usize);
                self.gather(node, &mut ids);
                ids
            }
            Part::References(ids, _) => ids.clone(),
        };
        let right = ids.split_off(ids.len() / 2);
        [Some(self.part(ids)), Some(self.part(right))]
    }

    fn leaf(&self, part: &Part, prims: &mut Vec<u32>, (): &mut ()) -> Aabb {
        let bounds = match part {
            Part::Subtree(node, _) => {
                self.gather(node, prims);
                node.bounds()
            }
            Part::References(ids, bounds) => {
                prims.extend(ids);
                *bounds
            }
        };
        prims.iter_mut().for_each(|id| *id = self.references.prim(*id));
        bounds
    }

    fn mark(&self, (): &()) -> usize {
        0
    }

    fn release(&self, (): &mut (), _: usize) {}
}

/// Builds the auxiliary LBVH and nothing better.
#[derive(Default)]
pub struct Lbvh {
    auxiliary: Auxiliary,
    memory: Memory<()>,
}

impl Builder for Lbvh {
    fn name(&self) -> &'static str {
        "lbvh"
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!({ "code_bits": super::morton::BITS })
    }

    fn build(&mut self, mesh: &Mesh) -> Build {
        let references = References::whole(mesh);
        let mut phases = self.auxiliary.build(&references, QUARTET);
        let mut watch = Stopwatch::start();
        let collapse = Collapse { tree: &self.auxiliary.tree, keys: &self.auxiliary.order.keys, references };
        let tree = top_down::build(&collapse, collapse.root(), &references, &mut self.memory);
        watch.lap("nodes");
        phases.extend(watch.phases);
        let auxiliary_nodes = 2 * self.auxiliary.tree.pairs.len() as u64 + 1;
        let counts = Counts { auxiliary_nodes, ..Counts::default() };
        Build::finish(tree, phases, counts, self.auxiliary.bytes() + self.memory.bytes())
    }

    fn recycle(&mut self, tree: Bvh4) {
        self.memory.recycle(tree);
    }
}
