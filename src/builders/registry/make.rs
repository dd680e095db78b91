//! From a configuration to a builder, over triangles and over boxes: the same builders with other leaves.

use super::Config;
use crate::builders::api::builder::{BoxBuilder, Builder};
use crate::builders::api::config_error::ConfigError;
use crate::builders::clusters::aac::pipeline::Aac;
use crate::builders::clusters::ploc::pipeline::Ploc;
use crate::builders::hunt::pipeline::Hunt;
use crate::builders::lbvh::direct::pipeline::Lbvh;
use crate::builders::optimise::optimised_phr::OptimisedPhr;
use crate::builders::phr::extensions::clustered::ClusteredPhr;
use crate::builders::phr::pipeline::Phr;
use crate::bvh::{IdBlock, TriangleBlock};

/// The builder of a configuration, of leaves of blocks that are made of items.
macro_rules! boxed {
    ($name:expr, $config:expr, $block:ty, $item:ty) => {
        match $config {
            Config::Lbvh => Box::<Lbvh<N, $block, $item>>::default(),
            Config::Aac(config) => Box::new(Aac::<N, $block>::new(config)?),
            Config::Ploc(config) => Box::new(Ploc::<N, $block>::new(config)?),
            Config::Hunt(config) => Box::new(Hunt::<N, $block>::new($name, config)?),
            Config::Phr(config) => Box::new(Phr::<N, $block>::new($name, config)?),
            Config::ClusteredPhr(config) => Box::new(ClusteredPhr::<N, $block, $item>::new($name, config)?),
            Config::OptimisedPhr(config) => Box::new(OptimisedPhr::<N, $block>::new($name, config)?),
        }
    };
}

/// The builder of a configuration over triangles.
///
/// # Errors
/// A parameter out of range.
pub(crate) fn over_triangles<const N: usize>(
    name: &'static str,
    config: Config,
) -> Result<Box<dyn Builder<N>>, ConfigError> {
    Ok(boxed!(name, config, TriangleBlock, [u32; 4]))
}

/// The builder of a configuration over boxes.
///
/// # Errors
/// A parameter out of range.
pub(crate) fn over_boxes<const N: usize>(
    name: &'static str,
    config: Config,
) -> Result<Box<BoxBuilder<N>>, ConfigError> {
    Ok(boxed!(name, config, IdBlock, u32))
}
