//! The builder `phr-best`: a tree of PHR, optimised before it is widened.

use super::config::OptimiseConfig;
use super::optimiser::Optimiser;
use crate::builders::api::builder::{Build, Builder};
use crate::builders::api::config_error::ConfigError;
use crate::builders::lbvh::config::AuxiliaryConfig;
use crate::builders::phr::config::{Extensions, PhrConfig};
use crate::builders::phr::memory::CutMemory;
use crate::builders::phr::pipeline::recursion_and_cut;
use crate::builders::prims::geometry::Geometry;
use crate::bvh::limits::BLOCK;
use crate::bvh::{LeafBlock, TriangleBlock, WideBvh};
use crate::simd::Isa;
use std::fmt;

/// Parameters of [`OptimisedPhr`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OptimisedPhrConfig {
    /// Of the tree; its `max_leaf` does not count, as that of [`OptimiseConfig::costs`] does, and for the same
    /// reason it has no `collapse`.
    pub phr: PhrConfig,
    /// Of its optimisation.
    pub optimise: OptimiseConfig,
}

impl OptimisedPhrConfig {
    /// That of `phr-best`: a tree from larger cuts of single triangles than those of [`PhrConfig::QUALITY`], with
    /// spatial splits in smaller parts, optimised as a whole.
    pub const DEFAULT: Self = Self {
        phr: PhrConfig {
            alpha: 0.55,
            delta: 8.0,
            max_cut: 1 << 16,
            spatial_threshold: 3e-4,
            extensions: Extensions {
                auxiliary: AuxiliaryConfig { clusters: None, ..PhrConfig::QUALITY.extensions.auxiliary },
                cut_share: Some(1.0 / 32.0),
                local_threshold: None,
                subtree_sweep: Some(64),
                collapse: None,
                ..PhrConfig::QUALITY.extensions
            },
            ..PhrConfig::QUALITY
        },
        optimise: OptimiseConfig::DEFAULT,
    };
}

/// Builds trees of nodes of up to `N` children by PHR and optimises; memory is kept between builds.
pub struct OptimisedPhr<const N: usize, B: LeafBlock = TriangleBlock> {
    name: &'static str,
    config: OptimisedPhrConfig,
    /// Leaves of one block: which are worth more is decided in the end.
    phr: PhrConfig,
    memory: CutMemory<N, B>,
    optimiser: Optimiser<N, B>,
    isa: Isa,
}

impl<const N: usize, B: LeafBlock> fmt::Debug for OptimisedPhr<N, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OptimisedPhr")
            .field("name", &self.name)
            .field("config", &self.config)
            .finish_non_exhaustive()
    }
}

impl<const N: usize, B: LeafBlock> OptimisedPhr<N, B> {
    /// A builder called `name` in records.
    ///
    /// # Errors
    /// A parameter out of range, and `collapse`.
    pub fn new(name: &'static str, config: OptimisedPhrConfig) -> Result<Self, ConfigError> {
        Self::with_isa(name, config, Isa::best())
    }

    /// A builder with the given instructions.
    pub(crate) fn with_isa(
        name: &'static str,
        config: OptimisedPhrConfig,
        isa: Isa,
    ) -> Result<Self, ConfigError> {
        config.phr.check().map_err(|error| error.within("phr"))?;
        config.optimise.check().map_err(|error| error.within("optimise"))?;
        if config.phr.extensions.collapse.is_some() {
            let [value, none] = ["on", "none"].map(String::from);
            return Err(ConfigError { field: "phr.collapse".into(), value, least: none.clone(), most: none });
        }
        let phr = PhrConfig { max_leaf: BLOCK, ..config.phr };
        Ok(Self { name, config, phr, memory: CutMemory::default(), optimiser: Optimiser::default(), isa })
    }
}

impl<const N: usize, G: Geometry> Builder<N, G> for OptimisedPhr<N, G::Block> {
    fn name(&self) -> &'static str {
        self.name
    }

    #[cfg(feature = "serde")]
    fn config(&self) -> serde_json::Value {
        serde_json::json!(self.config)
    }

    fn build(&mut self, geometry: &G) -> Build<N, G::Block> {
        let CutMemory { auxiliary, recursion: memory } = &mut self.memory;
        let extensions = &self.phr.extensions;
        let all = (geometry, geometry.prims());
        let mut watch = extensions.auxiliary_tree.build(auxiliary, all, &extensions.auxiliary, self.isa);
        let begun = recursion_and_cut(auxiliary, geometry, &self.phr, self.isa);
        let tree = self.optimiser.build(begun, geometry, memory, &self.config.optimise, &mut watch);
        self.memory.finish(tree, watch)
    }

    fn recycle(&mut self, tree: WideBvh<N, G::Block>) {
        self.optimiser.recycle(tree);
    }
}
