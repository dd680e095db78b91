//! Embree as a contender and as the reference. This file and its two halves are all of the driver that knows
//! whether Embree is there; without it, the reference is our own last builder.

#[cfg(feature = "embree")]
mod with;
#[cfg(feature = "embree")]
pub use with::{cells, isa, kernels_of_ours, library, reference, visit, with_graft};

#[cfg(not(feature = "embree"))]
mod without;
#[cfg(not(feature = "embree"))]
pub use without::{cells, isa, kernels_of_ours, library, reference, visit, with_graft};
