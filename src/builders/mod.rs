//! Builders: from an indexed mesh to a traversable [`Bvh4`](crate::bvh::Bvh4). The modules, in reading order:
//!
//! * `prims`: references to triangles; needles are presplit;
//! * `binary`: binary trees; `wide`: wide trees (paper 4.5, 4.6);
//! * `lbvh`: the auxiliary BVH (4.7), and the builder `lbvh`;
//! * `split`: object splits (4.2) and spatial splits (4.4) of a cut;
//! * `phr`: cuts, their refinement (4.1, 4.3) and the recursion over them: the builders `phr-*`;
//! * `clusters`: binary trees of clusters, made wide; `aac` and `ploc` make them bottom-up; `binned`: binned SAH;
//! * `hunt`, `aac`: the builders the paper compares with; `ploc`: a newer one;
//! * `optimise`: `phr-best`;
//! * `registry`: builders by name;
//! * `foreign`: trees that were made elsewhere, widened.
//!
//! `builder` and `config_error` are what they share, `naive` is the oracle of the tests, `steps` has single steps for
//! benchmarks.

mod aac;
mod binary;
mod binned;
mod builder;
mod clusters;
mod config_error;
mod foreign;
mod hunt;
mod lbvh;
#[cfg(test)]
mod naive;
mod optimise;
mod phr;
mod ploc;
mod prims;
mod registry;
mod split;
#[doc(hidden)]
pub mod steps;
#[cfg(test)]
mod testing;
mod wide;

pub use aac::{Aac, AacConfig};
pub use binned::BinnedSahConfig;
pub use builder::{Build, Builder, Counts, Phase};
pub use config_error::ConfigError;
pub use foreign::{ForeignTree, Opened, widened};
pub use hunt::{Hunt, HuntConfig};
pub use lbvh::auxiliary::{AuxiliaryConfig, Clusters};
pub use lbvh::direct::Lbvh;
pub use optimise::{OptimiseConfig, OptimisedPhr, OptimisedPhrConfig};
pub use phr::{AuxiliaryTree, Extensions, LocalThreshold, Phr, PhrConfig};
pub use ploc::{Ploc, PlocConfig};
pub use prims::presplit::PresplitConfig;
pub use registry::{ABLATION, NAMES, OVER, WITHOUT, by_name, on_request};
pub use wide::optimal::CollapseCosts;
