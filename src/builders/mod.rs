//! Builders: from an indexed mesh to a traversable [`Bvh4`].

pub(crate) mod aac;
pub(crate) mod binary;
mod builder;
pub(crate) mod hunt;
pub(crate) mod lbvh;
#[cfg(test)]
mod naive;
pub(crate) mod optimise;
pub(crate) mod phr;
pub(crate) mod prims;
mod registry;
pub(crate) mod split;
#[doc(hidden)]
pub mod steps;
pub(crate) mod wide;

pub use aac::{Aac, AacConfig};
pub use builder::{Build, Builder, Counts, Phase};
pub use hunt::{Hunt, HuntConfig};
pub use lbvh::auxiliary::Clusters;
pub use lbvh::direct::Lbvh;
pub use optimise::best::{Best, BestConfig};
pub use optimise::{Costs, OptimiseConfig};
pub use phr::{OwnThreshold, Phr, PhrConfig};
pub use prims::presplit::PresplitConfig;
pub use registry::{ABLATION, NAMES, by_name};
