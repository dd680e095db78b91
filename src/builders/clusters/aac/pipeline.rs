//! The builder `aac`.

use super::clustering::cluster;
use super::config::AacConfig;
use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::builder::{Build, Builder, Counts, Stopwatch};
use crate::builders::clusters::collapse::ClusterTree;
use crate::builders::config_error::ConfigError;
use crate::builders::lbvh::sort::{MortonOrder, SortBits};
use crate::builders::wide::build;
use crate::builders::wide::memory::Memory;
use crate::bvh::WideBvh;
use crate::geometry::Mesh;
use crate::memory::huge_pages;

/// Builds trees of nodes of up to `N` children by AAC; memory is kept between builds.
pub struct Aac<const N: usize> {
    config: AacConfig,
    order: MortonOrder,
    tree: BinaryTree,
    memory: Memory<Vec<u32>, N>,
}

impl<const N: usize> Aac<N> {
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

impl<const N: usize> Builder<N> for Aac<N> {
    fn name(&self) -> &'static str {
        "aac"
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!(self.config)
    }

    fn build(&mut self, mesh: &Mesh) -> Build<N> {
        let mut watch = Stopwatch::start();
        self.order.sort(mesh, mesh.prims(), None, SortBits::All, self.memory.blocks(mesh.len()), &mut watch);
        let mut keys = std::mem::take(&mut self.order.keys);
        huge_pages::resize(&mut self.tree.pairs, mesh.len().saturating_sub(1), [Node::ZERO; 2]);
        self.tree.root = cluster(&self.config, self.order.refs(mesh), &mut keys, &mut self.tree.pairs);
        self.order.keys = keys;
        watch.lap("clusters");
        let refs = self.order.refs(mesh);
        let clusters = ClusterTree { tree: &self.tree, keys: &self.order.keys, refs, has_rows: true };
        let tree = build::build(&clusters, clusters.root(), mesh, &mut self.memory);
        watch.lap("nodes");
        let counts = Counts { auxiliary_nodes: 2 * mesh.len() as u64, ..Counts::default() };
        Build { tree, phases: watch.phases, counts }
    }

    fn recycle(&mut self, tree: WideBvh<N>) {
        self.memory.recycle(tree);
    }
}
