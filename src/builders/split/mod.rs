//! Splits of a cut in two: object splits (paper 4.2) and spatial splits (4.4), and sweeps down to the leaves.
//!
//! * [`cost`]: what the sides of a split cost (equations 1 and 3);
//! * [`object`], [`spatial`]: one file each defines the split, the others find the same one faster;
//! * [`by_triangles`]: both by the triangles below nodes, an experiment;
//! * [`three_axes`]: sweeps along all axes at once, for cuts of middling length and for [`subtree_sweep`];
//! * [`subtree_sweep`]: subtrees of a few references, split down to leaves in one go, and [`cell_order`], the order
//!   they are swept in.

pub(crate) mod by_triangles;
pub(crate) mod cell_order;
pub(crate) mod cost;
pub(crate) mod object;
pub(crate) mod spatial;
pub(crate) mod subtree_sweep;
pub(crate) mod three_axes;
