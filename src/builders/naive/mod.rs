//! The oracle: the builders over cuts as the paper writes them down (Hendrich, Meister, Bittner 2017), AAC and PLOC, as
//! simple as they can be. The fast builders must agree with it node for node.

mod aac;
mod auxiliary;
mod builders;
mod cheapest;
mod compare;
mod cut;
mod full_leaves;
mod member;
mod meshes;
mod ploc;
mod recursion;
pub(crate) mod splits;
mod subtree;
pub(crate) mod wide;
