//! Builders: from an indexed mesh to a traversable [`Bvh4`](crate::bvh::Bvh4). The modules, in reading order:
//!
//! * `prims`: references to triangles, or to boxes of anything; needles are presplit;
//! * `binary`: binary trees; `wide`: wide trees (paper 4.5, 4.6), also of trees made elsewhere;
//! * `lbvh`: the auxiliary BVH (4.7), and the builder `lbvh`;
//! * `clusters`: binary trees of clusters, merged bottom-up by `aac` and `ploc`, widened;
//! * `split`: object splits (4.2) and spatial splits (4.4) of a cut;
//! * `phr`: cuts, their refinement (4.1, 4.3) and the recursion over them: the builders `phr-*`;
//! * `hunt`: a method the paper compares with, as `aac`;
//! * `optimise`: `phr-best`;
//! * `registry`: builders by name, with some fields of their configuration changed or none.
//!
//! `api` is what they share, `naive` is the oracle of the tests, `steps` has single steps for benchmarks and the
//! splits of a build for pictures.

mod api;
mod binary;
mod clusters;
mod hunt;
mod lbvh;
#[cfg(test)]
mod naive;
mod optimise;
mod phr;
mod prims;
mod registry;
mod split;
#[doc(hidden)]
pub mod steps;
#[cfg(test)]
mod testing;
mod wide;

pub use crate::memory::OutOfMemory;
pub use api::builder::{BoxBuilder, Build, Builder, Counts, Phase};
pub use api::config_error::ConfigError;
pub use clusters::aac::{config::AacConfig, pipeline::Aac};
pub use clusters::ploc::{config::PlocConfig, pipeline::Ploc};
pub use hunt::pipeline::{Hunt, HuntConfig};
pub use lbvh::config::{AuxiliaryConfig, Clusters};
pub use lbvh::direct::pipeline::Lbvh;
pub use optimise::config::OptimiseConfig;
pub use optimise::optimised_phr::{OptimisedPhr, OptimisedPhrConfig};
pub use phr::config::{Extensions, LocalThreshold, PhrConfig};
pub use phr::extensions::{
    auxiliary_tree::AuxiliaryTree,
    binned::config::BinnedSahConfig,
    clustered::{ClusteredPhr, ClusteredPhrConfig},
    merged::MergedPhr,
};
pub use phr::pipeline::Phr;
pub use prims::boxes::{Boxes, BoxesError};
pub use prims::geometry::Geometry;
pub use prims::presplit::PresplitConfig;
pub use prims::primitives::Primitives;
pub use registry::by_name::{by_name, over_boxes};
#[cfg(feature = "serde")]
pub use registry::recipe::{Recipe, error::RecipeError};
pub use registry::{ABLATION, CutConfig, NAMES, OVER, cuts_of, on_request};
pub use wide::foreign::{ForeignTree, Opened, widened};
pub use wide::optimal::CollapseCosts;
pub use wide::refit::RefitError;
