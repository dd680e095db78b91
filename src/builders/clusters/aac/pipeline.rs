//! The builder `aac`.

use super::clustering::cluster;
use super::config::AacConfig;
use crate::builders::api::builder::{Build, Builder};
use crate::builders::api::config_error::ConfigError;
use crate::builders::clusters::memory::ClusterMemory;
use crate::builders::prims::geometry::Geometry;
use crate::bvh::{LeafBlock, TriangleBlock, WideBvh};
use std::fmt;

/// Builds trees of nodes of up to `N` children by AAC; memory is kept between builds.
pub struct Aac<const N: usize, B: LeafBlock = TriangleBlock> {
    config: AacConfig,
    memory: ClusterMemory<N, B>,
}

impl<const N: usize, B: LeafBlock> fmt::Debug for Aac<N, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Aac").field("config", &self.config).finish_non_exhaustive()
    }
}

impl<const N: usize, B: LeafBlock> Aac<N, B> {
    /// A builder with the given parameters.
    ///
    /// # Errors
    /// A parameter out of range.
    pub fn new(config: AacConfig) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self { config, memory: ClusterMemory::default() })
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
        let Self { config, memory } = self;
        memory.build(geometry, true, |refs, keys, pairs| cluster(config, refs, keys, pairs))
    }

    fn recycle(&mut self, tree: WideBvh<N, G::Block>) {
        self.memory.wide.recycle(tree);
    }
}
