//! The memory of builders by clusters, kept from build to build, and the pipeline that they share.

use super::widen::ClusterTree;
use crate::builders::api::builder::{Build, Counts, Stopwatch};
use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::lbvh::key::MortonKey;
use crate::builders::lbvh::sort::MortonOrder;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::builders::wide::build;
use crate::builders::wide::memory::Memory;
use crate::bvh::TriangleBlock;

/// The memory of a builder by clusters.
pub(crate) struct ClusterMemory<const N: usize, B = TriangleBlock> {
    order: MortonOrder,
    tree: BinaryTree,
    /// Of the wide tree.
    pub wide: Memory<Vec<u32>, N, B>,
}

impl<const N: usize, B> Default for ClusterMemory<N, B> {
    fn default() -> Self {
        Self { order: MortonOrder::default(), tree: BinaryTree::default(), wide: Memory::default() }
    }
}

impl<const N: usize, B> ClusterMemory<N, B> {
    /// Sorts the primitives of `geometry`, has `cluster` merge them to a binary tree, of which it returns the root, and
    /// widens that; `has_rows` as in [`ClusterTree`].
    pub fn build<G: Geometry<Block = B>>(
        &mut self,
        geometry: &G,
        has_rows: bool,
        cluster: impl FnOnce(&PrimRefs<'_, G>, &mut [MortonKey], &mut Vec<[Node; 2]>) -> Option<Node>,
    ) -> Build<N, B> {
        let Self { order, tree, wide } = self;
        let mut watch = Stopwatch::start(geometry.len());
        order.sort_all(geometry, wide.blocks(geometry.len()), &mut watch);
        let mut keys = std::mem::take(&mut order.keys);
        let refs = order.refs(geometry);
        tree.root = cluster(&refs, &mut keys, &mut tree.pairs);
        watch.lap("clusters");
        let clusters = ClusterTree { tree, keys: &keys, refs, has_rows };
        let built = build::build(&clusters, clusters.root(), geometry, wide);
        order.keys = keys;
        watch.lap("nodes");
        Build { tree: built, phases: watch.phases, counts: Counts::default() }
    }
}
