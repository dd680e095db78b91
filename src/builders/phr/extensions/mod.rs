//! Extensions: they change the tree.

pub(crate) mod collapse;
