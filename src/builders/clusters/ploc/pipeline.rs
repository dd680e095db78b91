//! The builder `ploc`.

use super::clustering::Clustering;
use super::config::PlocConfig;
use crate::builders::api::builder::{Build, Builder};
use crate::builders::api::config_error::ConfigError;
use crate::builders::clusters::memory::ClusterMemory;
use crate::builders::prims::geometry::Geometry;
use crate::bvh::{LeafBlock, TriangleBlock, WideBvh};
use crate::simd::Isa;
use std::fmt;

/// Builds trees of nodes of up to `N` children by PLOC; memory is kept between builds.
pub struct Ploc<const N: usize, B: LeafBlock = TriangleBlock> {
    config: PlocConfig,
    isa: Isa,
    clustering: Clustering,
    memory: ClusterMemory<N, B>,
}

impl<const N: usize, B: LeafBlock> fmt::Debug for Ploc<N, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ploc").field("config", &self.config).finish_non_exhaustive()
    }
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
        Ok(Self { config, isa, clustering: Clustering::default(), memory: ClusterMemory::default() })
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
        let Self { config, isa, clustering, memory } = self;
        memory.build(geometry, false, |refs, keys, pairs| {
            clustering.cluster((config.radius, *isa), refs, keys, pairs)
        })
    }

    fn recycle(&mut self, tree: WideBvh<N, G::Block>) {
        self.memory.wide.recycle(tree);
    }
}
