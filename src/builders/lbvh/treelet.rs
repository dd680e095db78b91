//! The LBVH over a run of sorted codes that fits the cache, for those who open it. It needs no search: it is the
//! Cartesian tree of the heights at which neighbours part, made in one pass with a stack (cf. Apetrei 2014).

use crate::builders::binary::{BinaryTree, Node};
use crate::builders::lbvh::cartesian::Waiting;
use crate::builders::lbvh::deltas::Heights;
use crate::builders::lbvh::equal_codes::SameCode;
use crate::builders::lbvh::prefetch;
use crate::builders::lbvh::sort::{Key, reference};
use crate::builders::prims::refs::References;
use crate::builders::wide::top_down::QUARTET;
use crate::geometry::Aabb;
use crate::parallel::ordered_append::{Batch, Place};

/// Which subtrees become leaves.
#[derive(Clone, Copy)]
pub(crate) struct Leaves {
    /// Those of at most so many references,
    pub always: u32,
    /// and clusters: those of at most so many
    pub most: u32,
    /// whose box has at most this half area.
    pub area: f32,
}

impl Leaves {
    /// Whether so many references, more than always are a leaf, in a box are a cluster.
    #[inline]
    fn has_cluster(self, count: u32, bounds: Aabb) -> bool {
        count <= self.most && bounds.half_area() <= self.area
    }
}

/// The subtree over one run, built by one task; links are relative to its own pairs.
#[derive(Default)]
pub(crate) struct Run {
    /// The subtree.
    pub tree: BinaryTree,
    /// Where the leaves begin, and where the last ends.
    pub leaves: Vec<u32>,
    bounds: Vec<Aabb>,
    heights: Heights,
    same_code: SameCode,
    copied_keys: Vec<Key>,
    copied_bounds: Vec<Aabb>,
}

impl Run {
    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        (self.bounds.capacity() + self.copied_bounds.capacity()) * size_of::<Aabb>()
            + self.copied_keys.capacity() * size_of::<Key>()
            + self.tree.pairs.capacity() * size_of::<[Node; 2]>()
            + self.leaves.capacity() * size_of::<u32>()
            + self.heights.bytes()
            + self.same_code.bytes()
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
        self.part_equal_codes(keys, depth, leaves.always);
        self.heights.leaves(leaves.always, &mut self.leaves);
        let root = if leaves.always == 1 {
            self.unite::<1>(first, leaves)
        } else {
            self.unite::<{ QUARTET as usize }>(first, leaves)
        };
        self.tree.root = Some(root);
        root
    }

    fn part_equal_codes(&mut self, keys: &mut [Key], depth: u32, leaf: u32) {
        let Self { same_code, bounds, heights, copied_keys, copied_bounds, .. } = self;
        same_code.begin(keys.len());
        let mut begin = 0;
        while let Some(equal) = heights.equal_codes(begin) {
            begin = equal.end;
            if equal.len() > leaf.max(2) as usize {
                same_code.add(equal.clone(), bounds[equal].iter().map(|bounds| bounds.center2()));
            }
        }
        same_code.part([depth, leaf], heights);
        same_code.reorder(keys, copied_keys);
        same_code.reorder(bounds, copied_bounds);
    }

    /// Makes the tree over leaves of at most `MOST` references, the first of which is at position `first`.
    fn unite<const MOST: usize>(&mut self, first: usize, rule: Leaves) -> Node {
        let Self { tree, leaves, bounds, heights, .. } = self;
        tree.pairs.clear();
        let mut waiting = Waiting::new(Node::ZERO);
        let mut unite = |children: [Node; 2]| {
            let node = Node::inner(&children, tree.pairs.len());
            if rule.has_cluster(node.count(), node.bounds()) {
                // What is in a cluster is one itself.
                Node::leaf(node.bounds(), children[0].run().start, node.count())
            } else {
                tree.pairs.push(children);
                node
            }
        };
        for leaf in leaves.windows(2) {
            let [begin, end] = [leaf[0] as usize, leaf[1] as usize];
            // Some may be united twice: the number of references cannot be foreseen.
            let all = (0..MOST).map(|i| bounds[(begin + i).min(end - 1)]).collect();
            let height = heights.before(begin);
            waiting.unite_below(height, &mut unite);
            waiting.push(Node::leaf(all, first + begin, (end - begin) as u32), height);
        }
        waiting.unite_below(u8::MAX, &mut unite);
        waiting.last()
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
