//! The builder `ploc`.

use super::clustering::Clustering;
use super::config::PlocConfig;
use crate::builders::api::builder::{Build, Builder, Counts, Stopwatch};
use crate::builders::api::config_error::ConfigError;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::clusters::widen::ClusterTree;
use crate::builders::lbvh::sort::MortonOrder;
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::build;
use crate::builders::wide::memory::Memory;
use crate::bvh::{LeafBlock, TriangleBlock, WideBvh};
use crate::simd::Isa;

/// Builds trees of nodes of up to `N` children by PLOC; memory is kept between builds.
pub struct Ploc<const N: usize, B: LeafBlock = TriangleBlock> {
    config: PlocConfig,
    isa: Isa,
    order: MortonOrder,
    clustering: Clustering,
    tree: BinaryTree,
    memory: Memory<Vec<u32>, N, B>,
}

impl<const N: usize, B: LeafBlock> Ploc<N, B> {
    /// A builder with the given parameters.
    ///
    /// # Errors
    /// A parameter out of range.
    pub fn new(config: PlocConfig) -> Result<Self, ConfigError> {
        Self::with_isa(config, Isa::best())
    }

    /// A builder with the given instructions.
    pub(crate) fn with_isa(config: PlocConfig, isa: Isa) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self {
            config,
            isa,
            order: MortonOrder::default(),
            clustering: Clustering::default(),
            tree: BinaryTree::default(),
            memory: Memory::default(),
        })
    }
}

impl<const N: usize, G: Geometry> Builder<N, G> for Ploc<N, G::Block> {
    fn name(&self) -> &'static str {
        "ploc"
    }

    #[cfg(feature = "serde")]
    fn config(&self) -> serde_json::Value {
        serde_json::json!(self.config)
    }

    fn build(&mut self, geometry: &G) -> Build<N, G::Block> {
        let mut watch = Stopwatch::start();
        self.order.sort_all(geometry, self.memory.blocks(geometry.len()), &mut watch);
        let (refs, keys) = (self.order.refs(geometry), &self.order.keys);
        let Self { config, isa, clustering, tree, .. } = self;
        tree.root = clustering.cluster((config.radius, *isa), &refs, keys, &mut tree.pairs);
        watch.lap("clusters");
        let clusters = ClusterTree { tree, keys, refs, has_rows: false };
        let built = build::build(&clusters, clusters.root(), geometry, &mut self.memory);
        watch.lap("nodes");
        Build { tree: built, phases: watch.phases, counts: Counts::default() }
    }

    fn recycle(&mut self, tree: WideBvh<N, G::Block>) {
        self.memory.recycle(tree);
    }
}
