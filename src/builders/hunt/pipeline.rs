//! The builders `hunt-*`.

use super::constant_length::ConstantLength;
use crate::builders::api::builder::{Build, Builder};
use crate::builders::api::config_error::{ConfigError, check};
use crate::builders::lbvh::auxiliary::Auxiliary;
use crate::builders::phr::config::PhrConfig;
use crate::builders::phr::cut::OwnedCut;
use crate::builders::phr::memory::CutMemory;
use crate::builders::phr::recursion::CutRecursion;
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::build;
use crate::bvh::limits::{BLOCK, MAX_LEAF};
use crate::bvh::{LeafBlock, TriangleBlock, WideBvh};
use crate::simd::Isa;
use std::fmt;

/// Parameters of Hunt's method.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HuntConfig {
    /// Nodes of every cut, as far as there are enough; 2 to 65536.
    pub cut_length: usize,
    /// Most triangles of a leaf, as in [`PhrConfig::max_leaf`].
    pub max_leaf: u32,
}

/// Builds by Hunt's method; memory is kept between builds.
pub struct Hunt<const N: usize, B: LeafBlock = TriangleBlock> {
    name: &'static str,
    config: HuntConfig,
    /// The parameters that the recursion shares with PHR; without spatial splits.
    cuts: PhrConfig,
    memory: CutMemory<N, B>,
    isa: Isa,
}

impl<const N: usize, B: LeafBlock> fmt::Debug for Hunt<N, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Hunt").field("name", &self.name).field("config", &self.config).finish_non_exhaustive()
    }
}

impl<const N: usize, B: LeafBlock> Hunt<N, B> {
    /// A builder called `name` in records.
    ///
    /// # Errors
    /// A parameter out of range.
    pub fn new(name: &'static str, config: HuntConfig) -> Result<Self, ConfigError> {
        Self::with_isa(name, config, Isa::best())
    }

    /// A builder with the given instructions.
    pub(crate) fn with_isa(name: &'static str, config: HuntConfig, isa: Isa) -> Result<Self, ConfigError> {
        Ok(Self { name, config, cuts: config.of_cuts()?, memory: CutMemory::default(), isa })
    }
}

impl<const N: usize, G: Geometry> Builder<N, G> for Hunt<N, G::Block> {
    fn name(&self) -> &'static str {
        self.name
    }

    #[cfg(feature = "serde")]
    fn config(&self) -> serde_json::Value {
        serde_json::json!(self.config)
    }

    fn build(&mut self, geometry: &G) -> Build<N, G::Block> {
        let CutMemory { auxiliary, recursion: memory } = &mut self.memory;
        let mut watch = auxiliary.build(geometry, &self.cuts.extensions.auxiliary);
        let (recursion, cut) =
            recursion_and_cut(auxiliary, geometry, (&self.cuts, self.config.cut_length), self.isa);
        let tree = build::build(&recursion, cut, geometry, memory);
        watch.lap("cuts and nodes");
        self.memory.finish(tree, watch)
    }

    fn recycle(&mut self, tree: WideBvh<N, G::Block>) {
        self.memory.recursion.recycle(tree);
    }
}

impl HuntConfig {
    /// The parameters that the recursion shares with PHR.
    ///
    /// # Errors
    /// A parameter out of range.
    pub(crate) fn of_cuts(&self) -> Result<PhrConfig, ConfigError> {
        let Self { cut_length, max_leaf } = *self;
        check("cut_length", cut_length, 2..=1 << 16)?;
        check("max_leaf", max_leaf, BLOCK..=MAX_LEAF)?;
        Ok(PhrConfig { spatial_threshold: f32::INFINITY, max_leaf, ..PhrConfig::FAST })
    }
}

/// The recursion over a scene by cuts of constant length, and the initial cut that it begins with.
pub(crate) fn recursion_and_cut<'a, G: Geometry>(
    auxiliary: &'a Auxiliary,
    geometry: &'a G,
    (cuts, length): (&'a PhrConfig, usize),
    isa: Isa,
) -> (CutRecursion<'a, ConstantLength, G>, Option<OwnedCut>) {
    CutRecursion::new(auxiliary, geometry, cuts, ConstantLength(length), isa).with_initial_cut((0.0, length))
}
