//! Builders by name.

#[cfg(feature = "serde")]
use super::recipe::Recipe;
use super::{config, make};
use crate::builders::api::builder::{BoxBuilder, Builder};

/// The builder of trees of nodes of up to `N` children, 4 or 8, called `name`, or `None`; names are those of
/// [`NAMES`](crate::builders::NAMES) and [`on_request`](crate::builders::on_request) and, with the feature `serde`,
/// these with changes: `phr-hq[delta=8]`. Another width is refused by the compiler:
///
/// ```compile_fail
/// let builder = phr::builders::by_name::<12>("phr-speed");
/// ```
pub fn by_name<const N: usize>(name: &str) -> Option<Box<dyn Builder<N>>> {
    let found = config(name).and_then(|(name, config)| make::over_triangles(name, config).ok());
    #[cfg(feature = "serde")]
    let found = found.or_else(|| Recipe::parse(name).ok().map(|recipe| recipe.builder()));
    found
}

/// The same over boxes of anything, under the name that it has without changes.
pub fn over_boxes<const N: usize>(name: &str) -> Option<Box<BoxBuilder<N>>> {
    let found = config(name).and_then(|(name, config)| make::over_boxes(name, config).ok());
    #[cfg(feature = "serde")]
    let found = found.or_else(|| Recipe::parse(name).ok().map(|recipe| recipe.builder_over_boxes()));
    found
}
