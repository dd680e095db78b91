//! The LBVH over a run of sorted codes that fits the cache. It needs no search: it is the Cartesian tree of the
//! heights at which neighbours part, made in one pass with a stack (cf. Apetrei 2014).

use super::binary::{BinaryTree, Node};
use super::heights::Heights;
use super::in_order::{Batch, Place};
use super::morton_order::{Key, reference};
use super::prefetch;
use super::references::References;
use super::same_code::SameCode;
use super::top_down::QUARTET;
use crate::geometry::Aabb;

/// Which subtrees become leaves.
#[derive(Clone, Copy)]
pub(super) struct Leaves {
    /// Those of at most so many references,
    pub always: u32,
    /// and clusters: those of at most so many
    pub most: u32,
    /// whose box has at most this half area.
    pub area: f32,
}

impl Leaves {
    /// Leaves of at most `count` references.
    pub fn of(count: u32) -> Self {
        Self { always: count, most: count, area: 0.0 }
    }

    /// Whether so many references, more than always are a leaf, in a box are a cluster.
    #[inline]
    fn has_cluster(self, count: u32, bounds: Aabb) -> bool {
        count <= self.most && bounds.half_area() <= self.area
    }
}

/// More than the heights there are: each subtree on the stack has one of its own.
const WAITING: usize = 128;

/// The subtree over one run, built by one task; links are relative to its own pairs.
#[derive(Default)]
pub(super) struct Run {
    /// The subtree.
    pub tree: BinaryTree,
    /// Where the leaves begin, and where the last ends.
    pub leaves: Vec<u32>,
    bounds: Vec<Aabb>,
    heights: Heights,
    same_code: SameCode,
}

impl Run {
    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        self.bounds.capacity() * size_of::<Aabb>()
            + self.tree.pairs.capacity() * size_of::<[Node; 2]>()
            + self.leaves.capacity() * size_of::<u32>()
            + self.heights.bytes()
    }

    /// Builds the subtree over `keys`, which begin at position `first` and have been parted by the middle `depth`
    /// times. Returns the root.
    pub fn build(
        &mut self,
        references: &References<'_>,
        keys: &mut [Key],
        first: usize,
        depth: u32,
        leaves: Leaves,
    ) -> Node {
        // All boxes first: a plain loop has many loads from memory on their way at once, and more if asked for.
        self.bounds.clear();
        self.bounds.extend(keys.iter().enumerate().map(|(i, &key)| {
            prefetch::triangle(references.mesh, keys, i);
            references.bounds(reference(key))
        }));
        self.heights.of_codes(keys);
        let mut begin = 0;
        while let Some(equal) = self.heights.equal_codes(begin) {
            if equal.len() > leaves.always.max(2) as usize {
                let Self { same_code, bounds, heights, .. } = self;
                same_code.part(equal.clone(), [depth, leaves.always], keys, bounds, heights);
            }
            begin = equal.end;
        }
        self.heights.leaves(leaves.always, &mut self.leaves);
        let root = if leaves.always == 1 {
            self.unite::<1>(first, leaves)
        } else {
            self.unite::<{ QUARTET as usize }>(first, leaves)
        };
        self.tree.root = Some(root);
        root
    }

    /// Makes the tree over leaves of at most `MOST` references, the first of which is at position `first`.
    fn unite<const MOST: usize>(&mut self, first: usize, rule: Leaves) -> Node {
        let Self { tree, leaves, bounds, heights, .. } = self;
        tree.pairs.clear();
        let mut waiting = Waiting::default();
        for leaf in leaves.windows(2) {
            let [begin, end] = [leaf[0] as usize, leaf[1] as usize];
            // Some may be united twice: the number of references cannot be foreseen.
            let all = (0..MOST).map(|i| bounds[(begin + i).min(end - 1)]).collect();
            let height = heights.before(begin);
            waiting.unite_below(height, rule, &mut tree.pairs);
            waiting.push(Node::leaf(all, first + begin, (end - begin) as u32), height);
        }
        waiting.unite_below(u8::MAX, rule, &mut tree.pairs);
        waiting.nodes[waiting.last]
    }
}

/// Subtrees that wait for siblings to their right: each parts from the one before at a lower height than that from
/// its own.
struct Waiting {
    nodes: [Node; WAITING],
    heights: [u8; WAITING],
    /// The first subtree is at 1, above what is higher than all.
    last: usize,
}

impl Default for Waiting {
    fn default() -> Self {
        Self { nodes: [Node::ZERO; WAITING], heights: [u8::MAX; WAITING], last: 0 }
    }
}

impl Waiting {
    #[inline]
    fn push(&mut self, node: Node, height: u8) {
        self.last += 1;
        self.nodes[self.last] = node;
        self.heights[self.last] = height;
    }

    /// Unites those that part below `height`.
    #[inline]
    fn unite_below(&mut self, height: u8, leaves: Leaves, pairs: &mut Vec<[Node; 2]>) {
        while self.heights[self.last] < height {
            let children = [self.nodes[self.last - 1], self.nodes[self.last]];
            self.last -= 1;
            let node = Node::inner(&children, pairs.len());
            self.nodes[self.last] = if leaves.has_cluster(node.count(), node.bounds()) {
                // What is in a cluster is one itself.
                Node::leaf(node.bounds(), children[0].run().start, node.count())
            } else {
                pairs.push(children);
                node
            };
        }
    }
}

impl Batch for Run {
    type A = [Node; 2];
    type B = ();

    fn elements(&self) -> (&[[Node; 2]], &[()]) {
        (&self.tree.pairs, &[])
    }

    fn moved(pair: &[Node; 2], at: Place) -> [Node; 2] {
        pair.map(|node| node.moved(at[0] as u32))
    }

    fn clear(&mut self) {
        self.tree.pairs.clear();
    }
}
