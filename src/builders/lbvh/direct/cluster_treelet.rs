//! One treelet of an auxiliary BVH with finished leaves. As [`super::treelet`], but only subtrees that are clusters are
//! widened; what is above them becomes pairs of the auxiliary BVH, and leaves that are not compact remain leaves of it.

use super::treelet::DirectTreelet;
use crate::builders::binary::node::Node;
use crate::builders::lbvh::cartesian::cartesian_tree;
use crate::builders::lbvh::key::{MortonKey, key_of, reference};
use crate::builders::lbvh::top_tree::Treelet;
use crate::builders::lbvh::treelet::LeafRule;
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::branchless::Slot;
use crate::builders::wide::treelet::WideTreelet;
use crate::bvh::Link;
use crate::bvh::limits::FINISHED_LEVELS;
use crate::geometry::Aabb;
use crate::simd::Isa;

/// The auxiliary BVH of a treelet.
pub(crate) struct AboveClusters {
    /// Its root.
    pub root: Node,
    /// Above the finished leaves; links are relative to them.
    pub pairs: Vec<[Node; 2]>,
}

/// Memory of a task that builds one treelet.
#[derive(Default)]
pub(crate) struct ClusterTreelet<I, const N: usize> {
    direct: DirectTreelet<I, N>,
    subtrees: Subtrees,
    /// The pairs of the largest clusters.
    clusters: Vec<u32>,
    copied_keys: Vec<MortonKey>,
}

impl<I: Copy + Default, const N: usize> ClusterTreelet<I, N> {
    /// Builds the tree over the keys of a treelet, whole primitives of `geometry`. The code in the first key of each
    /// leaf gives way to its link, relative to `wide`.
    pub fn build<G: Geometry<Item = I>>(
        &mut self,
        isa: Isa,
        geometry: &G,
        Treelet { first, depth, keys }: Treelet<'_>,
        rule: LeafRule,
        wide: &mut WideTreelet<N, G::Block>,
    ) -> AboveClusters {
        let Self { direct, subtrees, clusters, copied_keys } = self;
        let is_compact = |bounds: Aabb| rule.is_compact(bounds);
        direct.make_leaves(isa, geometry, (keys, depth), is_compact, &mut wide.blocks);
        let DirectTreelet { deltas, equal_codes, leaves, slots, widen, .. } = direct;
        equal_codes.reorder(keys, copied_keys);
        widen.pairs.clear();
        subtrees.of_leaves(slots, leaves);
        clusters.clear();
        let mut pairs = Vec::with_capacity(leaves.len() / 4);
        let mut close = |slot: &Slot, subtrees: &Subtrees| {
            let Subtree { begin, count, .. } = subtrees.of(slot);
            if slot.is_closed() {
                return Node::of_pair(slot.bounds(), begin as usize, count);
            }
            if slot.is_open() {
                return Node::leaf(slot.bounds(), first + begin as usize, count);
            }
            if slot.is_leaf() {
                put_link(&mut keys[begin as usize], Link::leaf(slot.index(), 1));
            } else {
                clusters.push(slot.index() as u32);
            }
            Node::finished(slot.bounds(), first + begin as usize, count)
        };
        let of_leaves =
            slots.iter().zip(&*leaves).map(|(&slot, &begin)| (slot, deltas.before(begin as usize)));
        let root = cartesian_tree(Slot::NONE, of_leaves, |children| {
            let [left, right] = children.each_ref().map(|child| subtrees.of(child));
            let parent = Slot::inner(&children, widen.pairs.len());
            let count = left.count + right.count;
            let levels = left.levels.max(right.levels) + 1;
            // One branch: that a subtree is a cluster is foreseen near the leaves, but not by which of the limits.
            let is_cluster =
                (count <= rule.most) & rule.is_compact(parent.bounds()) & (levels <= FINISHED_LEVELS);
            widen.pairs.push(children);
            if is_cluster {
                subtrees.push(Subtree { begin: left.begin, count, levels });
                return parent;
            }
            let pair = children.each_ref().map(|child| close(child, subtrees));
            // Subtrees of clusters are clusters: nothing above is one.
            subtrees.push(Subtree { begin: pairs.len() as u32, count, levels: FINISHED_LEVELS });
            pairs.push(pair);
            Slot::closed(parent.bounds(), widen.pairs.len() - 1)
        });
        let root = close(&root, subtrees);
        if !clusters.is_empty() {
            let nodes = &mut wide.nodes;
            isa.run(
                #[inline(always)]
                || widen.write_below(clusters, nodes),
            );
        }
        for &pair in &*clusters {
            let begin = subtrees.of_pair(pair as usize).begin;
            put_link(&mut keys[begin as usize], Link::inner(widen.number(pair as usize) as usize));
        }
        AboveClusters { root, pairs }
    }
}

fn put_link(key: &mut MortonKey, link: Link) {
    *key = key_of(link.bits(), reference(*key));
}

/// What is known of a subtree.
#[derive(Clone, Copy)]
struct Subtree {
    /// Where its references begin in the treelet; of a closed one the index of its pair in the auxiliary BVH.
    begin: u32,
    /// Its references.
    count: u32,
    /// Inner levels.
    levels: u32,
}

/// Leaves with a block, and then pairs in order.
#[derive(Default)]
struct Subtrees {
    all: Vec<Subtree>,
    leaves: usize,
    /// Leaves without a block.
    open: Vec<Subtree>,
}

impl Subtrees {
    /// Begins with the leaves, given by where each begins and the last one ends.
    fn of_leaves(&mut self, slots: &[Slot], leaves: &[u32]) {
        let Self { all, open, .. } = self;
        all.clear();
        open.clear();
        for (slot, leaf) in slots.iter().zip(leaves.windows(2)) {
            let subtree = Subtree { begin: leaf[0], count: leaf[1] - leaf[0], levels: 0 };
            if slot.is_open() { open.push(subtree) } else { all.push(subtree) }
        }
        self.leaves = self.all.len();
    }

    fn push(&mut self, pair: Subtree) {
        self.all.push(pair);
    }

    #[inline(always)]
    fn of(&self, slot: &Slot) -> Subtree {
        if slot.is_open() {
            return self.open[slot.index()];
        }
        self.all[slot.index() + if slot.is_leaf() { 0 } else { self.leaves }]
    }

    fn of_pair(&self, pair: usize) -> Subtree {
        self.all[self.leaves + pair]
    }
}
