//! Progressive Hierarchical Refinement (Hendrich, Meister, Bittner 2017): the paper's builder.
//!
//! | paper | file |
//! |---|---|
//! | 3.2, Figure 3: the recursion | [`recursion`], one split of it in [`split_cut`] |
//! | 4.1 initial cut | [`initial_cut`] |
//! | 4.2 object splits | [`crate::builders::split::object`] |
//! | 4.3 refinement, equation 2 | [`refine`] |
//! | 4.4 spatial splits | [`crate::builders::split::spatial`], clipping in [`clip`] |
//! | 4.5, 4.6 wide tree, threads | [`crate::builders::wide`] |
//! | 4.7 auxiliary BVH | [`crate::builders::lbvh`] |
//!
//! [`pipeline`] has the steps in order; [`exact`] holds shortcuts that give the same tree, [`extensions`] what
//! changes it. [`cut`] and [`policy`] are shared with Hunt's method; [`watched`] shows the splits of a build.

pub(crate) mod clip;
pub(crate) mod config;
pub(crate) mod cut;
pub(crate) mod exact;
pub(crate) mod extensions;
pub(crate) mod initial_cut;
pub(crate) mod memory;
pub(crate) mod pipeline;
pub(crate) mod policy;
pub(crate) mod recursion;
pub(crate) mod ref_order;
pub(crate) mod refine;
mod split_cut;
mod split_down;
pub(crate) mod watched;
