//! The builder `lbvh`: the auxiliary BVH, its leaves filled, as a wide tree, without refinement. Treelets are built,
//! widened and written while they are in the cache; the tree over them is widened at the end.

use super::treelet::DirectTreelet;
use crate::builders::api::builder::{Build, Builder, Counts, Stopwatch};
use crate::builders::binary::kind::Kind;
use crate::builders::lbvh::sort::MortonOrder;
use crate::builders::lbvh::top_tree::{Treelet, top_tree};
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::memory::Memory;
use crate::builders::wide::open_largest::{Priority, open_largest, replace};
use crate::builders::wide::treelet::{self, WideRoot, WideTreelet};
use crate::bvh::{LeafBlock, Link, TriangleBlock, WideBvh, WideNode};
use crate::geometry::Aabb;
use crate::memory::pool::Pool;
use crate::memory::stream::Vectors;
use crate::parallel::ordered_append;
use crate::simd::Isa;
use arrayvec::ArrayVec;
use std::fmt;

/// Builds the LBVH of paper 4.7 as a tree of nodes of up to `N` children, but fills its leaves: a subtree of up to 16
/// primitives has as few blocks as hold them. Memory is kept between builds.
pub struct Lbvh<const N: usize, B: LeafBlock = TriangleBlock, I = [u32; 4]> {
    order: MortonOrder,
    treelets: Pool<DirectTreelet<I, N>>,
    memory: Memory<(), N, B>,
    isa: Isa,
}

impl<const N: usize, B: LeafBlock, I> fmt::Debug for Lbvh<N, B, I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Lbvh").finish_non_exhaustive()
    }
}

impl<const N: usize, B: LeafBlock, I: Default> Default for Lbvh<N, B, I> {
    fn default() -> Self {
        Self::with_isa(Isa::best())
    }
}

impl<const N: usize, G: Geometry> Builder<N, G> for Lbvh<N, G::Block, G::Item> {
    fn name(&self) -> &'static str {
        "lbvh"
    }

    #[cfg(feature = "serde")]
    fn config(&self) -> serde_json::Value {
        serde_json::json!({ "code_bits": crate::bvh::limits::MORTON_BITS })
    }

    fn build(&mut self, geometry: &G) -> Build<N, G::Block> {
        let mut watch = Stopwatch::start(geometry.len());
        self.order.sort_all(geometry, self.memory.blocks(geometry.len()), &mut watch);
        let mut keys = std::mem::take(&mut self.order.keys);
        let tree = if keys.is_empty() { WideBvh::default() } else { self.tree(geometry, &mut keys) };
        self.order.keys = keys;
        watch.lap("tree");
        Build { tree, phases: watch.phases, counts: Counts::default() }
    }

    fn recycle(&mut self, tree: WideBvh<N, G::Block>) {
        self.memory.recycle(tree);
    }
}

impl<const N: usize, B: LeafBlock, I: Default> Lbvh<N, B, I> {
    /// A builder with the given instructions.
    pub(crate) fn with_isa(isa: Isa) -> Self {
        Self { order: MortonOrder::default(), treelets: Pool::default(), memory: Memory::default(), isa }
    }
}

impl<const N: usize, B: LeafBlock + Vectors, I: Copy + Default + Send> Lbvh<N, B, I> {
    /// The tree over one or more sorted keys.
    fn tree<G: Geometry<Block = B, Item = I>>(&mut self, geometry: &G, keys: &mut [u64]) -> WideBvh<N, B> {
        let refs = &self.order.refs(geometry);
        let (mut nodes, mut blocks) = self.memory.arrays(geometry.len());
        let (top, tasks) = top_tree(refs, keys, 0);
        let make = |i: usize, wide: &mut WideTreelet<N, B>| {
            let mut treelet = self.treelets.take();
            let Treelet { depth, keys, .. } = tasks.take(i);
            let built = treelet.build(self.isa, refs, keys, depth, wide);
            self.treelets.put(treelet);
            built
        };
        let built = ordered_append::append(tasks.len(), &self.memory.treelets, &mut nodes, &mut blocks, make);
        let subtrees = treelet::moved(built);
        let treelets: Vec<TopNode> = subtrees.into_iter().map(TopNode::Treelet).collect();
        let mut pairs = Vec::with_capacity(tasks.len());
        let root = top.fold(&treelets, &mut |parts| TopNode::join([parts[0], parts[1]], &mut pairs));
        let tree = root.emit(&pairs, &mut nodes);
        tree.map_or_else(WideBvh::default, |(bounds, root)| WideBvh { root, bounds, nodes, blocks })
    }
}

/// A node of the top tree on its way to wide nodes.
#[derive(Clone, Copy)]
enum TopNode {
    Treelet(WideRoot),
    /// Its box, and the place of its children.
    Pair(Aabb, usize),
}

impl TopNode {
    fn bounds(&self) -> Aabb {
        match self {
            Self::Treelet(subtree) => subtree.map_or(Aabb::EMPTY, |(bounds, _)| bounds),
            Self::Pair(bounds, _) => *bounds,
        }
    }

    /// Appends the pair of two nodes; returns their parent.
    fn join(children: [Self; 2], pairs: &mut Vec<[Self; 2]>) -> Self {
        pairs.push(children);
        Self::Pair(children[0].bounds().union(children[1].bounds()), pairs.len() - 1)
    }

    /// Appends the wide nodes below.
    fn emit<const N: usize>(self, pairs: &[[Self; 2]], nodes: &mut Vec<WideNode<N>>) -> WideRoot {
        if let Self::Treelet(subtree) = self {
            return subtree;
        }
        let priority = |node: &Self| {
            let kind = if matches!(node, Self::Pair(..)) { Kind::Inner } else { Kind::Leaf };
            Priority::new(kind, node.bounds().half_area())
        };
        let mut children = ArrayVec::<Self, N>::from_iter([self]);
        open_largest(&mut children, priority, |children, next| {
            let Self::Pair(_, pair) = children[next] else { return None };
            replace(children, next, pairs[pair]);
            Some(())
        });
        let built: ArrayVec<(Aabb, Link), N> =
            children.into_iter().filter_map(|child| child.emit(pairs, nodes)).collect();
        treelet::append_node(&built, nodes)
    }
}
