//! PLOC: parallel locally-ordered clustering (Meister and Bittner 2018). Triangles in Morton order are clusters;
//! again and again each looks for its nearest among the clusters up to a radius before and after it, where distance
//! is the area of the common box, and those that are each other's nearest are merged, until one is left. The binary
//! tree is widened by [`crate::builders::clusters`].
//!
//! Three changes: codes have 32 bits for any scene; a distance and which neighbour it is of share 32 bits, so that
//! distances that differ by less than about 2^-17 of themselves (2^-15 at the largest radius) count as equal, and of
//! equal ones the nearest in order is taken, such that equal triangles pair off; and after a pass that merges almost
//! nothing, as among boxes that lie one within another, the next merges all neighbours, so that there are few passes
//! over any scene.
//!
//! [`nearest`] searches, in vectors; [`pass`] merges, by tasks; [`clustering`] repeats passes.

pub(crate) mod clustering;
pub(crate) mod config;
mod nearest;
mod pass;
pub(crate) mod pipeline;
