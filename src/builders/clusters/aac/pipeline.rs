//! The builder `aac`.

use super::clustering::cluster;
use super::config::AacConfig;
use crate::builders::api::builder::{Build, Builder, Counts, Stopwatch};
use crate::builders::api::config_error::ConfigError;
use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::clusters::widen::ClusterTree;
use crate::builders::lbvh::sort::MortonOrder;
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::build;
use crate::builders::wide::memory::Memory;
use crate::bvh::{LeafBlock, TriangleBlock, WideBvh};
use crate::memory::huge_pages;

/// Builds trees of nodes of up to `N` children by AAC; memory is kept between builds.
pub struct Aac<const N: usize, B: LeafBlock = TriangleBlock> {
    config: AacConfig,
    order: MortonOrder,
    tree: BinaryTree,
    memory: Memory<Vec<u32>, N, B>,
}

impl<const N: usize, B: LeafBlock> Aac<N, B> {
    /// A builder with the given parameters.
    ///
    /// # Errors
    /// A parameter out of range.
    pub fn new(config: AacConfig) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self {
            config,
            order: MortonOrder::default(),
            tree: BinaryTree::default(),
            memory: Memory::default(),
        })
    }
}

impl<const N: usize, G: Geometry> Builder<N, G> for Aac<N, G::Block> {
    fn name(&self) -> &'static str {
        "aac"
    }

    #[cfg(feature = "serde")]
    fn config(&self) -> serde_json::Value {
        serde_json::json!(self.config)
    }

    fn build(&mut self, geometry: &G) -> Build<N, G::Block> {
        let mut watch = Stopwatch::start();
        self.order.sort_all(geometry, self.memory.blocks(geometry.len()), &mut watch);
        let mut keys = std::mem::take(&mut self.order.keys);
        huge_pages::resize(
            &mut self.tree.pairs,
            geometry.len().saturating_sub(1),
            [Node::ZERO; 2],
            "pairs of clusters",
        );
        self.tree.root = cluster(&self.config, self.order.refs(geometry), &mut keys, &mut self.tree.pairs);
        self.order.keys = keys;
        watch.lap("clusters");
        let refs = self.order.refs(geometry);
        let clusters = ClusterTree { tree: &self.tree, keys: &self.order.keys, refs, has_rows: true };
        let tree = build::build(&clusters, clusters.root(), geometry, &mut self.memory);
        watch.lap("nodes");
        Build { tree, phases: watch.phases, counts: Counts::default() }
    }

    fn recycle(&mut self, tree: WideBvh<N, G::Block>) {
        self.memory.recycle(tree);
    }
}
