//! From a configuration to a builder, over triangles and over boxes: the same builders with other leaves. They are
//! compiled with this crate, once for each width, not again with each program that asks for one of `N`.

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
use crate::bvh::limits::check_width;
use crate::bvh::{IdBlock, TriangleBlock};
use std::any::Any;

/// A builder of a configuration, of nodes of up to so many children and leaves of blocks that are made of items.
macro_rules! boxed {
    ($function:ident, $n:literal, $builder:ty, $block:ty, $item:ty) => {
        #[inline(never)]
        fn $function(name: &'static str, config: Config) -> Result<Box<$builder>, ConfigError> {
            Ok(match config {
                Config::Lbvh => Box::<Lbvh<$n, $block, $item>>::default(),
                Config::Aac(config) => Box::new(Aac::<$n, $block>::new(config)?),
                Config::Ploc(config) => Box::new(Ploc::<$n, $block>::new(config)?),
                Config::Hunt(config) => Box::new(Hunt::<$n, $block>::new(name, config)?),
                Config::Phr(config) => Box::new(Phr::<$n, $block>::new(name, config)?),
                Config::ClusteredPhr(config) => {
                    Box::new(ClusteredPhr::<$n, $block, $item>::new(name, config)?)
                }
                Config::OptimisedPhr(config) => Box::new(OptimisedPhr::<$n, $block>::new(name, config)?),
            })
        }
    };
}

boxed!(four_over_triangles, 4, dyn Builder<4>, TriangleBlock, [u32; 4]);
boxed!(eight_over_triangles, 8, dyn Builder<8>, TriangleBlock, [u32; 4]);
boxed!(four_over_boxes, 4, BoxBuilder<4>, IdBlock, u32);
boxed!(eight_over_boxes, 8, BoxBuilder<8>, IdBlock, u32);

/// The builder of a configuration over triangles.
///
/// # Errors
/// A parameter out of range.
pub(crate) fn over_triangles<const N: usize>(
    name: &'static str,
    config: Config,
) -> Result<Box<dyn Builder<N>>, ConfigError> {
    const { check_width::<N>() };
    Ok(if N == 4 {
        same(four_over_triangles(name, config)?)
    } else {
        same(eight_over_triangles(name, config)?)
    })
}

/// The builder of a configuration over boxes.
///
/// # Errors
/// A parameter out of range.
pub(crate) fn over_boxes<const N: usize>(
    name: &'static str,
    config: Config,
) -> Result<Box<BoxBuilder<N>>, ConfigError> {
    const { check_width::<N>() };
    Ok(if N == 4 { same(four_over_boxes(name, config)?) } else { same(eight_over_boxes(name, config)?) })
}

/// A builder of four or eight as the same of `N`, which is that number.
fn same<A: Any, B: Any>(builder: A) -> B {
    let builder: Box<dyn Any> = Box::new(builder);
    *builder.downcast().expect("N was compared")
}
