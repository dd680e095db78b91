//! What tree to build, and why it could not be built.

use crate::builders::{BoxesError, NAMES, OutOfMemory, on_request};

/// What tree to build: `BvhConfig::new("phr-quality", 8)`, or `BvhConfig { width: 4, ..BvhConfig::default() }`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BvhConfig<'a> {
    /// Name of a builder, one that [`by_name`](crate::builders::by_name) knows: of [`NAMES`], a variant, or, with the
    /// feature `serde`, one with changes, `phr-hq[delta=8]` or `phr-hq[delta=8+alpha=0.4]`.
    pub builder: &'a str,
    /// Most children of a node: 4 or 8.
    pub width: usize,
}

impl<'a> BvhConfig<'a> {
    /// The builder of this name, and nodes of up to `width` children, 4 or 8: checked when it builds.
    pub const fn new(builder: &'a str, width: usize) -> Self {
        Self { builder, width }
    }
}

impl Default for BvhConfig<'_> {
    /// `phr-speed`, 8-wide: built fast, traced well.
    fn default() -> Self {
        Self { builder: "phr-speed", width: 8 }
    }
}

/// Why a [`Bvh`](super::Bvh) could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BvhError {
    /// No builder has the name.
    #[error("no builder is called {0}; there are {list}", list = NAMES.join(", "))]
    NoSuchBuilder(String),
    /// A tree that is to be rebuilt does not tell by whom, or but the beginning of a long name, as its file has it.
    #[error(
        "the builder of this tree is not told, or not to the end; make it by Bvh::build, or build another"
    )]
    NoBuilder,
    /// A builder is to be changed in a way that cannot be, or at all where the feature `serde` is off.
    #[error("{0}")]
    Changes(String),
    /// No builder makes nodes of so many children.
    #[error("no tree has nodes of {0} children; give 4 or 8")]
    NoSuchWidth(usize),
    /// Boxes that cannot be built over.
    #[error(transparent)]
    Boxes(BoxesError),
    /// A transform under which no instance can be traced.
    #[error("the transform of instance {instance} is of no use: {reason}; leave the instance out")]
    Transform {
        /// Index of the instance.
        instance: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// A tree and a mesh that are to be used together.
    #[error("the tree is of another mesh, or the mesh was moved since; give that which it was built over")]
    NotOfMesh,
    /// No memory for a tree. A program compiled with `panic = "abort"` ends instead.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
    /// The tree's links lead out of it or in circles, or it is too deep.
    #[error("malformed tree: {0}; check it by WideBvh::validate")]
    Malformed(String),
}

impl BvhError {
    /// Why there is no builder called `name`.
    pub(super) fn of_name(name: &str) -> Self {
        let base = name.split_once('[').map(|(base, _)| base);
        if base.is_none_or(|base| !NAMES.iter().copied().chain(on_request()).any(|known| known == base)) {
            return Self::NoSuchBuilder(name.to_owned());
        }
        #[cfg(feature = "serde")]
        let why =
            crate::builders::Recipe::parse(name).map_or_else(|error| error.to_string(), |known| known.name());
        #[cfg(not(feature = "serde"))]
        let why = format!(
            "{name}: builders are changed by name where phr is compiled with its feature `serde`; ask for it, or give \
             the tree of a `builders::Phr` to `Bvh::try_from`"
        );
        Self::Changes(why)
    }
}

impl From<BoxesError> for BvhError {
    /// No memory for boxes is no memory, as for a tree.
    fn from(error: BoxesError) -> Self {
        match error {
            BoxesError::OutOfMemory(error) => Self::OutOfMemory(error),
            BoxesError::Invalid { .. } | BoxesError::TooMany(_) => Self::Boxes(error),
        }
    }
}
