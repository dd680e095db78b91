//! From a binary tree to a wide one, by opening the largest child first (paper 4.5).

use crate::builders::binary::{BinaryTree, Node};
use crate::builders::lbvh::prefetch::warm;
use crate::builders::lbvh::sort::{Key, reference};
use crate::builders::prims::refs::References;
use crate::builders::wide::top_down::{Kind, QUARTET, TopDown};
use crate::geometry::Aabb;

/// From this depth of the binary tree on, references are halved by count: a chain of clusters must not make the
/// tree deeper than traversal stacks allow.
const MAX_DEPTH: u32 = 64;

/// Collapses a binary tree: subtrees of at most four references become leaves.
#[derive(Clone, Copy)]
pub(crate) struct Collapse<'a> {
    /// The tree.
    pub tree: &'a BinaryTree,
    /// References in the order that the leaves' positions mean.
    pub keys: &'a [Key],
    /// What they refer to.
    pub references: References<'a>,
}

/// What is left to build.
#[derive(Clone, Copy)]
pub(crate) enum Part {
    /// A subtree at a depth of the binary tree.
    Subtree(Node, u32),
    /// References of a subtree too deep, as a range of the scratch memory, and their box.
    References(usize, u32, Aabb),
}

/// A part with references of its own.
pub(crate) struct OwnPart(Part, Vec<u32>);

impl Collapse<'_> {
    /// The whole tree.
    pub fn root(&self) -> Option<OwnPart> {
        self.tree.root.map(|root| OwnPart(Part::Subtree(root, 0), Vec::new()))
    }

    /// Appends the references below `node`.
    fn gather(&self, node: &Node, ids: &mut Vec<u32>) {
        if node.is_leaf() {
            ids.extend(self.keys[node.run()].iter().map(|&key| reference(key)));
        } else {
            self.tree.children(node).iter().for_each(|child| self.gather(child, ids));
        }
    }

    fn part(&self, first: usize, ids: &[u32]) -> Option<Part> {
        let bounds = ids.iter().map(|&id| self.references.bounds(id)).collect();
        Some(Part::References(first, ids.len() as u32, bounds))
    }
}

impl TopDown for Collapse<'_> {
    type Seed = OwnPart;
    type Part = Part;
    type Scratch = Vec<u32>;
    type Mark = usize;

    fn plant(&self, OwnPart(part, ids): OwnPart, scratch: &mut Vec<u32>) -> Part {
        let first = scratch.len();
        scratch.extend(ids);
        match part {
            Part::References(_, len, bounds) => Part::References(first, len, bounds),
            subtree @ Part::Subtree(..) => subtree,
        }
    }

    fn lift(&self, part: &Part, scratch: &Vec<u32>) -> OwnPart {
        match *part {
            Part::References(first, len, _) => OwnPart(*part, scratch[first..first + len as usize].to_vec()),
            Part::Subtree(..) => OwnPart(*part, Vec::new()),
        }
    }

    fn approach(&self, part: &Part, _: &Vec<u32>) {
        if let Part::Subtree(node, _) = part {
            warm(self.tree, self.keys, &self.references, node, 1);
        }
    }

    fn count(&self, part: &Part) -> u32 {
        match part {
            Part::Subtree(node, _) => node.count(),
            Part::References(_, len, _) => *len,
        }
    }

    fn half_area(&self, part: &Part) -> f32 {
        match part {
            Part::Subtree(node, _) => node.bounds().half_area(),
            Part::References(_, _, bounds) => bounds.half_area(),
        }
    }

    fn kind(&self, part: &Part) -> Kind {
        if self.count(part) <= QUARTET { Kind::Leaf } else { Kind::Inner }
    }

    fn split(&self, part: &Part, scratch: &mut Vec<u32>) -> [Option<Part>; 2] {
        let (first, len) = match *part {
            Part::Subtree(node, depth) if depth < MAX_DEPTH => {
                return self.tree.children(&node).map(|child| {
                    self.tree.prefetch(&child);
                    Some(Part::Subtree(child, depth + 1))
                });
            }
            Part::Subtree(node, _) => {
                let first = scratch.len();
                self.gather(&node, scratch);
                (first, node.count() as usize)
            }
            Part::References(first, len, _) => (first, len as usize),
        };
        let (left, right) = scratch[first..first + len].split_at(len / 2);
        [self.part(first, left), self.part(first + len / 2, right)]
    }

    fn leaf(&self, part: &Part, prims: &mut Vec<u32>, scratch: &mut Vec<u32>) -> Aabb {
        let bounds = match *part {
            Part::Subtree(node, _) => {
                self.gather(&node, prims);
                node.bounds()
            }
            Part::References(first, len, bounds) => {
                prims.extend(&scratch[first..first + len as usize]);
                bounds
            }
        };
        prims.iter_mut().for_each(|id| *id = self.references.prim(*id));
        bounds
    }

    fn mark(&self, scratch: &Vec<u32>) -> usize {
        scratch.len()
    }

    fn release(&self, scratch: &mut Vec<u32>, mark: usize) {
        scratch.truncate(mark);
    }
}
