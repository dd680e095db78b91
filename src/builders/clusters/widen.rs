//! From the binary tree of clusters to a wide one, the largest child opened first (paper 4.5).

use super::gathered::GatheredTree;
use crate::builders::binary::kind::Kind;
use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::lbvh::key::{MortonKey, reference};
use crate::builders::lbvh::prefetch;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::builders::wide::binary_source::Leaves;
use crate::builders::wide::top_down::{BinarySplits, TopDown};
use crate::builders::wide::treelet::{WideRoot, WideTreelet};
use crate::bvh::limits::{BLOCK, follows_clusters};
use crate::geometry::{Aabb, Mesh};
use arrayvec::ArrayVec;

/// A binary tree to be widened: subtrees of at most four references become leaves.
pub(crate) struct ClusterTree<'a, G = Mesh> {
    /// The tree.
    pub tree: &'a BinaryTree,
    /// References in the order that the leaves' positions mean.
    pub keys: &'a [MortonKey],
    /// What they refer to.
    pub refs: PrimRefs<'a, G>,
    /// Whether the pairs of a subtree lie in a row that ends with its root's, or nearly so.
    pub has_rows: bool,
}

/// An unbuilt subtree.
#[derive(Clone, Copy)]
pub(crate) enum ClusterPart {
    /// A subtree at a depth of the binary tree.
    Subtree(Node, u32),
    /// References of a subtree at too great a depth, which are halved by count: as a range of the scratch memory,
    /// and their box.
    References(usize, u32, Aabb),
}

/// A part with references of its own.
pub(crate) struct OwnedPart(ClusterPart, Vec<u32>);

impl<G: Geometry> ClusterTree<'_, G> {
    /// The whole tree.
    pub fn root(&self) -> Option<OwnedPart> {
        self.tree.root.map(|root| OwnedPart(ClusterPart::Subtree(root, 0), Vec::new()))
    }

    /// Appends the references below `node`, level by level, so that many pairs are fetched at a time: those of a
    /// level do not depend on each other.
    fn gather(&self, node: &Node, ids: &mut Vec<u32>) {
        let first = ids.len();
        let queue = first + node.count() as usize;
        ids.resize(queue, 0);
        // Inner nodes wait behind the references: their pairs, and where the references below begin.
        let place = |ids: &mut Vec<u32>, node: &Node, at: u32| match node.pair() {
            Some(pair) => ids.extend([pair as u32, at]),
            None => {
                let places = &mut ids[first + at as usize..];
                places.iter_mut().zip(&self.keys[node.run()]).for_each(|(to, &key)| *to = reference(key));
            }
        };
        place(ids, node, 0);
        let mut next = queue;
        while let Some(&[pair, at]) = ids.get(next..next + 2).and_then(<[u32]>::first_chunk) {
            let [left, right] = &self.tree.pairs[pair as usize];
            place(ids, left, at);
            place(ids, right, at + left.count());
            next += 2;
        }
        ids.truncate(queue);
    }

    fn part(&self, first: usize, ids: &[u32]) -> Option<ClusterPart> {
        let bounds = ids.iter().map(|&id| self.refs.bounds(id)).collect();
        Some(ClusterPart::References(first, ids.len() as u32, bounds))
    }
}

impl<G: Geometry> TopDown for ClusterTree<'_, G> {
    type Task = OwnedPart;
    type Part = ClusterPart;
    type Scratch = Vec<u32>;
    type Block = G::Block;

    fn import(&self, OwnedPart(mut part, ids): OwnedPart, scratch: &mut Vec<u32>) -> ClusterPart {
        if let ClusterPart::References(first, ..) = &mut part {
            *first = scratch.len();
        }
        scratch.extend(ids);
        part
    }

    fn export(&self, part: &ClusterPart, scratch: &Vec<u32>) -> OwnedPart {
        let ids = match *part {
            ClusterPart::References(first, len, _) => &scratch[first..first + len as usize],
            ClusterPart::Subtree(..) => &[],
        };
        OwnedPart(*part, ids.to_vec())
    }

    fn prefetch(&self, part: &ClusterPart, _: &Vec<u32>) {
        if let ClusterPart::Subtree(node, _) = part {
            if self.has_rows {
                prefetch::subtree(self.tree, self.keys, &self.refs, node, 1);
            } else {
                prefetch::run(self.tree, self.keys, &self.refs, node);
            }
        }
    }

    fn count(&self, part: &ClusterPart) -> u32 {
        match part {
            ClusterPart::Subtree(node, _) => node.count(),
            ClusterPart::References(_, len, _) => *len,
        }
    }

    fn is_leaf(&self, part: &ClusterPart) -> bool {
        self.kind(part) == Kind::Leaf
    }

    fn children<const N: usize>(
        &self,
        part: &ClusterPart,
        scratch: &mut Vec<u32>,
        children: &mut ArrayVec<ClusterPart, N>,
    ) {
        self.split_largest(part, scratch, children);
    }

    fn leaf(&self, part: &ClusterPart, prims: &mut Vec<u32>, scratch: &mut Vec<u32>) -> Aabb {
        let bounds = match *part {
            ClusterPart::Subtree(node, _) => {
                self.gather(&node, prims);
                node.bounds()
            }
            ClusterPart::References(first, len, bounds) => {
                prims.extend(&scratch[first..first + len as usize]);
                bounds
            }
        };
        prims.iter_mut().for_each(|id| *id = self.refs.prim(*id));
        bounds
    }

    fn try_emit<const N: usize>(
        &self,
        part: &ClusterPart,
        treelet: &mut WideTreelet<N, G::Block>,
        scratch: &mut Vec<u32>,
    ) -> Option<WideRoot> {
        let ClusterPart::Subtree(node, depth) = *part else { return None };
        let first = scratch.len();
        self.gather(&node, scratch);
        scratch[first..].iter_mut().for_each(|id| *id = self.refs.prim(*id));
        let leaves = Leaves::of(&self.refs, BLOCK);
        let gathered = GatheredTree { tree: self.tree, prims: &scratch[first..] };
        let subtree = gathered.emit(&node, depth, &leaves, treelet);
        scratch.truncate(first);
        subtree
    }
}

impl<G: Geometry> BinarySplits for ClusterTree<'_, G> {
    fn kind(&self, part: &ClusterPart) -> Kind {
        Kind::of_count(self.count(part))
    }

    fn half_area(&self, part: &ClusterPart) -> f32 {
        match part {
            ClusterPart::Subtree(node, _) => node.bounds().half_area(),
            ClusterPart::References(_, _, bounds) => bounds.half_area(),
        }
    }

    fn split(&self, part: &ClusterPart, scratch: &mut Vec<u32>) -> [Option<ClusterPart>; 2] {
        let (first, len) = match *part {
            ClusterPart::Subtree(node, depth) if follows_clusters(depth, node.count() as usize) => {
                return self.tree.children(&node).map(|child| {
                    self.tree.prefetch(&child);
                    Some(ClusterPart::Subtree(child, depth + 1))
                });
            }
            ClusterPart::Subtree(node, _) => {
                let first = scratch.len();
                self.gather(&node, scratch);
                (first, node.count() as usize)
            }
            ClusterPart::References(first, len, _) => (first, len as usize),
        };
        let (left, right) = scratch[first..first + len].split_at(len / 2);
        [self.part(first, left), self.part(first + len / 2, right)]
    }
}
