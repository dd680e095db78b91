//! One treelet of an auxiliary BVH with finished leaves. As [`super::treelet`], but only subtrees that are clusters are
//! widened; what is above them becomes pairs of the auxiliary BVH, and leaves that are not compact remain leaves of it.

use super::treelet::DirectTreelet;
use crate::builders::binary::node::Node;
use crate::builders::lbvh::cartesian::cartesian_tree;
use crate::builders::lbvh::key::{MortonKey, key_of, reference};
use crate::builders::lbvh::top_tree::Treelet;
use crate::builders::lbvh::treelet::LeafRule;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
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
    /// The pairs of the largest clusters.
    clusters: Vec<u32>,
    /// Where their references begin in the treelet.
    begins: Vec<u32>,
    copied_keys: Vec<MortonKey>,
}

/// A subtree of a treelet.
#[derive(Clone, Copy)]
struct Part {
    slot: Slot,
    /// Where its references begin in the treelet; of a closed one the index of its pair in the auxiliary BVH.
    begin: u32,
    /// Its references.
    count: u32,
    /// Inner levels.
    levels: u32,
}

impl Part {
    /// Never read.
    const NONE: Self = Self { slot: Slot::NONE, begin: 0, count: 0, levels: 0 };
}

impl<I: Copy + Default, const N: usize> ClusterTreelet<I, N> {
    /// Builds the tree over the keys of a treelet. The code in the first key of each leaf gives way to its link,
    /// relative to `wide`.
    pub fn build<G: Geometry<Item = I>>(
        &mut self,
        isa: Isa,
        refs: &PrimRefs<'_, G>,
        Treelet { first, depth, keys }: Treelet<'_>,
        rule: LeafRule,
        wide: &mut WideTreelet<N, G::Block>,
    ) -> AboveClusters {
        let Self { direct, clusters, begins, copied_keys } = self;
        let is_compact = |bounds: Aabb| rule.is_compact(bounds);
        direct.make_leaves(isa, refs, (keys, depth), is_compact, &mut wide.blocks);
        direct.equal_codes.reorder(keys, copied_keys);
        if !refs.fragments.is_empty() {
            direct.fit_pieces(refs, keys, is_compact, &mut wide.blocks);
        }
        let DirectTreelet { deltas, leaves, slots, widen, .. } = direct;
        widen.pairs.clear();
        clusters.clear();
        begins.clear();
        let mut pairs = Vec::new();
        let mut close = |Part { slot, begin, count, .. }: &Part| {
            if slot.is_closed() {
                return Node::of_pair(slot.bounds(), *begin as usize, *count);
            }
            let from = *begin as usize;
            if slot.is_bare() {
                return Node::leaf(slot.bounds(), first + from, *count);
            }
            if slot.is_leaf() {
                put_link(&mut keys[from], Link::of_blocks(slot.index(), 1));
            } else {
                clusters.push(slot.index() as u32);
                begins.push(*begin);
            }
            Node::finished(slot.bounds(), first + from, *count)
        };
        let of_leaves = slots.iter().zip(leaves.windows(2)).map(|(&slot, leaf)| {
            let [begin, end] = [leaf[0], leaf[1]];
            (Part { slot, begin, count: end - begin, levels: 0 }, deltas.before(begin as usize))
        });
        let root = cartesian_tree(Part::NONE, of_leaves, |parts| {
            let [left, right] = &parts;
            let children = parts.map(|part| part.slot);
            let slot = Slot::inner::<N>(&children, widen.pairs.len());
            let count = left.count + right.count;
            let levels = left.levels.max(right.levels) + 1;
            // One branch: that a subtree is a cluster is foreseen near the leaves, but not by which of the limits.
            let is_cluster =
                (count <= rule.most) & rule.is_compact(slot.bounds()) & (levels <= FINISHED_LEVELS);
            widen.pairs.push(children);
            if is_cluster {
                return Part { slot, begin: left.begin, count, levels };
            }
            pairs.push(parts.each_ref().map(&mut close));
            // Subtrees of clusters are clusters: nothing above is one.
            let slot = Slot::closed(slot.bounds(), widen.pairs.len() - 1);
            Part { slot, begin: pairs.len() as u32 - 1, count, levels: FINISHED_LEVELS }
        });
        let root = close(&root);
        if !clusters.is_empty() {
            let nodes = &mut wide.nodes;
            isa.run(
                #[inline(always)]
                || widen.write_below(clusters, nodes),
            );
        }
        for (&pair, &begin) in clusters.iter().zip(&*begins) {
            put_link(&mut keys[begin as usize], Link::of_node(widen.number(pair as usize) as usize));
        }
        AboveClusters { root, pairs }
    }
}

fn put_link(key: &mut MortonKey, link: Link) {
    *key = key_of(link.bits(), reference(*key));
}
