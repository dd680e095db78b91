//! The tree inside a committed scene, in Embree's own memory layout: a measuring instrument.
//!
//! 1. [`layout`]: where Embree keeps the tree, and how nodes and leaves lie in memory, all of it checked;
//! 2. [`native`]: reads Embree's tree into ours;
//! 3. [`graft`]: sets a tree of ours in place of Embree's, laid out as [`node_image`] in [`pages`] of its own.

pub mod graft;
mod layout;
pub mod native;
mod node_image;
mod pages;

pub use layout::Unavailable;
