//! Builders: from an indexed mesh to a traversable [`Bvh4`](crate::bvh::Bvh4). The modules, in reading order:
//!
//! * `prims`: references to triangles; needles are presplit;
//! * `binary`: binary trees; `wide`: wide trees (paper 4.5, 4.6);
//! * `lbvh`: the auxiliary BVH (4.7), and the builder `lbvh`;
//! * `split`: object splits (4.2) and spatial splits (4.4) of a cut;
//! * `phr`: cuts, their refinement (4.1, 4.3) and the recursion over them: the builders `phr-*`;
//! * `hunt`, `aac`: the builders the paper compares with;
//! * `optimise`: `phr-best`;
//! * `registry`: builders by name.
//!
//! `builder` and `config_error` are what they share, `naive` is the oracle of the tests, `steps` has single steps for
//! benchmarks and the splits of a build for pictures.

mod aac;
mod binary;
mod builder;
mod config_error;
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

pub use aac::{Aac, AacConfig};
pub use builder::{Build, Builder, Counts, Phase};
pub use config_error::ConfigError;
pub use hunt::{Hunt, HuntConfig};
pub use lbvh::auxiliary::{AuxiliaryConfig, Clusters};
pub use lbvh::direct::Lbvh;
pub use optimise::{OptimiseConfig, OptimisedPhr, OptimisedPhrConfig};
pub use phr::{Extensions, LocalThreshold, Phr, PhrConfig};
pub use prims::presplit::PresplitConfig;
pub use registry::{ABLATION, CutConfig, NAMES, WITHOUT, by_name, cuts_of, on_request};
pub use wide::optimal::CollapseCosts;
