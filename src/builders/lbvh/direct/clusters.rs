//! An auxiliary BVH with finished leaves: wide nodes and blocks of compact clusters are made with their treelet, while
//! its primitives are in the cache, as the builder `lbvh` makes them. Cuts do not open them, and no plane cuts them.

use super::cluster_treelet::{AboveClusters, ClusterTreelet};
use crate::builders::api::builder::Stopwatch;
use crate::builders::binary::node::Node;
use crate::builders::lbvh::area_scale::AreaScale;
use crate::builders::lbvh::auxiliary::Auxiliary;
use crate::builders::lbvh::config::AuxiliaryConfig;
use crate::builders::lbvh::key::{MortonKey, code, key_of, reference};
use crate::builders::lbvh::sort::SortBits;
use crate::builders::lbvh::top_tree::top_tree;
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::memory::{Arrays, Memory};
use crate::builders::wide::treelet::WideTreelet;
use crate::bvh::{LeafBlock, Link};
use crate::memory::huge_pages;
use crate::memory::pool::Pool;
use crate::memory::stream::Vectors;
use crate::parallel;
use crate::parallel::ordered_append::{self, Offset};
use crate::simd::Isa;

/// Memory of tasks, kept between builds.
pub(crate) struct ClusterTreelets<const N: usize, I>(Pool<ClusterTreelet<I, N>>);

impl<const N: usize, I: Default> Default for ClusterTreelets<N, I> {
    fn default() -> Self {
        Self(Pool::default())
    }
}

impl<const N: usize, I: Copy + Default + Send> ClusterTreelets<N, I> {
    /// Builds the LBVH of `geometry` in `auxiliary`, and the nodes and blocks of its leaves. In the first key of each
    /// leaf the code has given way to its link ([`link`](crate::builders::phr::ref_order::RefOrder::link)). The
    /// configuration has no bucket sort.
    pub fn build<G: Geometry<Item = I, Block: LeafBlock + Vectors>, S: Default>(
        &mut self,
        auxiliary: &mut Auxiliary,
        geometry: &G,
        config: &AuxiliaryConfig,
        memory: &mut Memory<S, N, G::Block>,
        (isa, watch): (Isa, &mut Stopwatch),
    ) -> Arrays<N, G::Block> {
        let Auxiliary { order, tree, scale, has_finished_leaves, .. } = auxiliary;
        let prims = geometry.prims();
        order.take_up(geometry, prims.clone(), config.presplit.as_ref(), watch);
        let references = geometry.len() + order.extra_references();
        order.sort(geometry, prims, SortBits::All, memory.blocks(references), watch);
        let mut keys = std::mem::take(&mut order.keys);
        let refs = order.refs(geometry);
        *scale = AreaScale::in_order(order.bounds(), &keys, &refs, config.calibration);
        *has_finished_leaves = true;
        let (mut nodes, mut blocks) = memory.arrays(references);
        tree.root = None;
        tree.pairs.clear();
        if !keys.is_empty() {
            let rule = config.rule(scale);
            let (top, tasks) = top_tree(&refs, &mut keys, 0);
            let make = |i: usize, wide: &mut WideTreelet<N, G::Block>| {
                let mut treelet = self.0.take();
                let task = tasks.take(i);
                let len = task.keys.len();
                let above = treelet.build(isa, &refs, task, rule, wide);
                self.0.put(treelet);
                (above, len)
            };
            let made = ordered_append::append(tasks.len(), &memory.treelets, &mut nodes, &mut blocks, make);
            drop(tasks);
            let roots = place(&made, &mut tree.pairs, &mut keys);
            tree.root =
                Some(top.fold(&roots, &mut |nodes| Node::join([nodes[0], nodes[1]], &mut tree.pairs)));
        }
        order.keys = keys;
        watch.lap("auxiliary tree");
        (nodes, blocks)
    }
}

/// What a treelet has made, its number of references, and the place of its nodes and blocks.
type Made = ((AboveClusters, usize), Offset);

/// Fills `pairs`, which is empty, with those above the leaves of all treelets, and makes the links in the first keys of
/// leaves, which are relative to a treelet, those of the whole. Returns the roots of the treelets.
fn place(made: &[Made], pairs: &mut Vec<[Node; 2]>, mut keys: &mut [MortonKey]) -> Vec<Node> {
    let own: usize = made.iter().map(|((above, _), _)| above.pairs.len()).sum();
    // One more for each treelet but one joins them.
    huge_pages::reserve(pairs, own + made.len(), "the auxiliary tree");
    pairs.resize(own, [Node::ZERO; 2]);
    let mut pairs = &mut pairs[..];
    let (mut first_pair, mut first_key) = (0, 0);
    let treelets = made.iter().map(|((above, len), offset)| {
        let places = pairs.split_off_mut(..above.pairs.len()).expect("there is a place for each pair");
        let keys = keys.split_off_mut(..*len).expect("each key is in a treelet");
        let treelet = Placed { above, offset: *offset, places, first_pair, keys, first_key };
        first_pair += above.pairs.len() as u32;
        first_key += len;
        treelet
    });
    parallel::map(treelets, Placed::place)
}

/// A treelet with its place in the whole.
struct Placed<'a> {
    above: &'a AboveClusters,
    offset: Offset,
    /// Of its pairs.
    places: &'a mut [[Node; 2]],
    first_pair: u32,
    keys: &'a mut [MortonKey],
    first_key: usize,
}

impl Placed<'_> {
    /// Returns its root.
    fn place(self) -> Node {
        let Self { above, offset: [nodes, blocks], places, first_pair, keys, first_key } = self;
        for (place, pair) in places.iter_mut().zip(&above.pairs) {
            *place = pair.map(|node| node.moved(first_pair));
        }
        let lone = [above.root];
        for leaf in above.pairs.iter().flatten().chain(&lone).filter(|node| node.is_finished()) {
            let key = &mut keys[leaf.run().start - first_key];
            let link = Link::from_bits(code(*key)).moved(nodes, blocks);
            *key = key_of(link.bits(), reference(*key));
        }
        above.root.moved(first_pair)
    }
}
