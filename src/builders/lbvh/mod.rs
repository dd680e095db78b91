//! The auxiliary BVH (paper 4.7): an LBVH over Morton codes.
//!
//! 1. [`morton`]: a code for each triangle, or for each piece of a presplit one; [`key`] joins code and reference;
//! 2. [`sort`]: bounds, presplitting, codes, and the radix sort by code;
//! 3. [`partition`]: where a run of sorted keys is divided in two, by definition;
//! 4. [`top_tree`]: runs are divided down to treelets that fit a cache;
//! 5. [`treelet`]: one task builds the tree of a treelet from [`deltas`], [`equal_codes`] and a [`cartesian`] tree;
//! 6. [`auxiliary`]: all of it, by its [`config`].
//!
//! [`direct`] is the builder `lbvh`, which fills the leaves of the same tree, widens it and refines nothing.
//! [`area_scale`] gives the area that thresholds are relative to; [`prefetch`] fetches triangles ahead; `refit` fits
//! the tree to a mesh that has moved.

pub(crate) mod area_scale;
pub(crate) mod auxiliary;
pub(crate) mod cartesian;
pub(crate) mod config;
pub(crate) mod deltas;
pub(crate) mod direct;
pub(crate) mod equal_codes;
pub(crate) mod key;
pub(crate) mod morton;
pub(crate) mod partition;
pub(crate) mod prefetch;
mod refit;
pub(crate) mod sort;
pub(crate) mod top_tree;
pub(crate) mod treelet;
