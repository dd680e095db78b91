//! Where [`super::config::Extensions`] change the tree, and the presets that use them.
//!
//! * [`presets`]: `phr-speed` and `phr-quality`;
//! * [`clustered`]: `phr-draft` and `phr-turbo`, cuts over clusters that are widened with the auxiliary tree;
//! * [`small_cuts`]: `subtree_sweep`, which splits by [`crate::builders::split::subtree_sweep`];
//! * [`collapse`]: the extension of that name;
//! * [`auxiliary_tree`]: other auxiliary trees than an LBVH; [`binned`] makes one of them;
//! * [`merged`]: the auxiliary trees of a static part and of a dynamic one under one root.
//!
//! The rest is a line where the paper's rule stands: `cut_share` in [`super::pipeline`], `local_threshold` (in
//! records `own_threshold`) in [`super::refine`], `clip_triangles` and `triangle_counts` in [`super::split_cut`],
//! those of the auxiliary BVH in [`crate::builders::lbvh`].

pub(crate) mod auxiliary_tree;
pub(crate) mod binned;
pub(crate) mod clustered;
pub(crate) mod collapse;
pub(crate) mod merged;
mod presets;
pub(crate) mod small_cuts;
