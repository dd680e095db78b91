//! Optimisation of a tree before it is widened: the binary splits of PHR are recorded, subtrees are reinserted
//! where they enlarge the tree least, and the result is collapsed to the cheapest wide tree.
//!
//! 1. [`record`]: the binary tree of the splits, as [`tree`];
//! 2. [`reinsertion`] of the most promising [`candidates`];
//! 3. collapse: choices of [`crate::builders::wide::optimal`], emitted by [`collapsed`].

mod candidates;
mod collapsed;
pub(crate) mod config;
pub(crate) mod optimised_phr;
mod optimiser;
mod record;
mod reinsertion;
#[cfg(test)]
mod tests;
mod tree;
