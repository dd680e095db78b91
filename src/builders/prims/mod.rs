//! What a tree is built over: references to triangles, some of them presplit.

pub(crate) mod needle;
pub(crate) mod presplit;
pub(crate) mod refs;
